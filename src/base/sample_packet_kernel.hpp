// SPDX-License-Identifier: Apache-2.0
// The random numbers of a packet of samples side by side.
#pragma once

#include <array>
#include <span>

#include "base/lanes.hpp"
#include "base/sample_stream.hpp"

namespace relumine {

/// Sixteen streams. Every number has the bits that the stream itself would give: SampleStream is the
/// definition, this is faster when most of the sixteen are asked the same.
class SamplePacket {
  public:
    template <typename T>
    using Lanes = relumine::Lanes<T>;

    /// The streams must outlive the packet.
    explicit SamplePacket(std::span<const SampleStream, packet_size> streams);

    /// Puts another packet's stream into a lane.
    void take(std::size_t lane, const SamplePacket& other, std::size_t other_lane);

    /// SampleStream::next1, for all sixteen.
    void next1(Dim dim, std::uint32_t vertex, Lanes<float>& u) const;
    /// SampleStream::next2, for all sixteen.
    void next2(Dim dim, std::uint32_t vertex, Lanes<float>& x, Lanes<float>& y) const;
    /// SampleStream::bits, for all sixteen.
    void bits(Dim dim, std::uint32_t vertex, Lanes<std::uint32_t>& bits) const;

  private:
    std::array<const SampleStream*, packet_size> streams_;
    bool mixed_or_stratified_;  // point sets that have no kernel
    PointSet set_;              // of all streams, unless mixed
    alignas(64) Lanes<std::uint64_t> keys_;
    alignas(64) Lanes<std::uint64_t> index_hashes_;      // hash(·, index) needs no more
    alignas(64) Lanes<std::uint32_t> reversed_indices_;  // bits in reverse order
};

}  // namespace relumine
