// SPDX-License-Identifier: Apache-2.0
// The kernel against SampleStream, on every instruction set that this machine has.
#include "base/sample_packet_kernel.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/targets.hpp"

namespace relumine {
namespace {

using testing::on_every_target;

using Streams = std::array<SampleStream, packet_size>;

Streams random_streams(std::uint64_t seed, PointSet set) {
    Streams streams;
    for (std::uint32_t i = 0; i < packet_size; ++i) {
        const auto index = static_cast<std::uint32_t>(hash(seed, i, 1));
        // Small indices, as renders have them, and any.
        streams[i] = {hash(seed, i), i % 4 == 0 ? index : index % 64, 64, set};
    }
    return streams;
}

/// How many of a packet's numbers have other bits than the streams' own.
int differences(const Streams& streams, const Streams& expected, Dim dim, std::uint32_t vertex) {
    const SamplePacket packet(streams);
    SamplePacket::Lanes<float> u, x, y;
    SamplePacket::Lanes<std::uint32_t> bits;
    packet.next1(dim, vertex, u);
    packet.next2(dim, vertex, x, y);
    packet.bits(dim, vertex, bits);
    int count = 0;
    for (std::size_t i = 0; i < packet_size; ++i) {
        count += u[i] != expected[i].next1(dim, vertex) ? 1 : 0;
        count += Point2{x[i], y[i]} != expected[i].next2(dim, vertex) ? 1 : 0;
        count += bits[i] != expected[i].bits(dim, vertex) ? 1 : 0;
    }
    return count;
}

TEST(SamplePacket, HasTheBitsOfItsStreams) {
    on_every_target([] {
        for (const PointSet set : {PointSet::sobol, PointSet::stratified, PointSet::independent})
            for (std::uint64_t seed = 0; seed < 50; ++seed)
                for (const std::uint32_t vertex : {0u, 1u, 7u, 0xffffffffu}) {
                    const Streams streams = random_streams(seed, set);
                    EXPECT_EQ(differences(streams, streams, Dim::direction, vertex), 0);
                    EXPECT_EQ(differences(streams, streams, Dim::light_choice, vertex), 0);
                }
    });
}

TEST(SamplePacket, TakesStreamsFromOthers) {
    on_every_target([] {
        for (const PointSet other_set : {PointSet::sobol, PointSet::stratified}) {
            Streams streams = random_streams(1, PointSet::sobol);
            const Streams others = random_streams(2, other_set);
            SamplePacket packet(streams);
            packet.take(3, SamplePacket(others), 7);
            SamplePacket::Lanes<float> u;
            packet.next1(Dim::lobe, 2, u);
            for (std::size_t i = 0; i < packet_size; ++i)
                EXPECT_EQ(u[i], (i == 3 ? others[7] : streams[i]).next1(Dim::lobe, 2));
        }
    });
}

TEST(SamplePacket, MayMixPointSets) {
    on_every_target([] {
        for (std::uint64_t seed = 0; seed < 50; ++seed) {
            Streams streams = random_streams(seed, PointSet::sobol);
            streams[seed % packet_size].set = PointSet::independent;
            EXPECT_EQ(differences(streams, streams, Dim::pixel, 0), 0);
        }
    });
}

TEST(SamplePacket, ADifferentBitIsNoticed) {
    const Streams streams = random_streams(1, PointSet::sobol);
    Streams mutants = streams;
    mutants[5].key ^= 1;
    mutants[11].index ^= 1;
    EXPECT_EQ(differences(streams, mutants, Dim::lobe, 3), 6);
}

}  // namespace
}  // namespace relumine
