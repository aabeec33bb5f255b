// SPDX-License-Identifier: Apache-2.0
// A hash of whatever a result depends on, to tell whether it is still the same.
#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/hash.hpp"

namespace relumine {

/// Collects values in order. Every step is a bijection of the state, so that a change of any 8 bytes shows;
/// changes that were chosen to cancel each other are not its business.
class Fingerprint {
  public:
    /// Raw bytes; what has padding must be added member by member.
    void add_bytes(std::span<const std::byte> bytes) {
        add_word(bytes.size());
        for (; bytes.size() >= sizeof(std::uint64_t); bytes = bytes.subspan(sizeof(std::uint64_t)))
            add_word(first_word(bytes, sizeof(std::uint64_t)));
        if (!bytes.empty()) add_word(first_word(bytes, bytes.size()));
    }
    template <typename T>
    requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void add(T value) {
        add_bytes(std::as_bytes(std::span(&value, 1)));
    }
    void add(std::string_view text) { add_bytes(std::as_bytes(std::span(text))); }
    template <typename T>
    requires std::is_trivially_copyable_v<T>
    void add_all(const std::vector<T>& values) { add_bytes(std::as_bytes(std::span(values))); }

    [[nodiscard]] std::uint64_t value() const { return state_; }

  private:
    static std::uint64_t first_word(std::span<const std::byte> bytes, std::size_t count) {
        std::uint64_t word = 0;
        std::memcpy(&word, bytes.data(), count);
        return word;
    }
    void add_word(std::uint64_t word) { state_ = mix(state_ ^ word) + 0x9e3779b97f4a7c15u; }

    std::uint64_t state_ = 0;
};

}  // namespace relumine
