// SPDX-License-Identifier: Apache-2.0
// Values as bytes in the order of this machine, and back with every length checked.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/message.hpp"
#include "relumine/error.hpp"

namespace relumine {

class ByteWriter {
  public:
    template <typename T>
    requires std::is_arithmetic_v<T>
    void put(T value) { put_all(std::span<const T>(&value, 1)); }
    void put(std::string_view text) {
        put(std::uint64_t{text.size()});
        put_all(std::span(text));
    }
    /// The values alone, without their number.
    template <typename T, std::size_t extent>
    void put_all(std::span<const T, extent> values) {
        const std::size_t begin = bytes_.size();
        bytes_.resize(begin + values.size_bytes());
        if (!values.empty()) std::memcpy(bytes_.data() + begin, values.data(), values.size_bytes());
    }
    void reserve(std::size_t bytes) { bytes_.reserve(bytes); }
    [[nodiscard]] std::vector<std::uint8_t> take_bytes() { return std::move(bytes_); }

  private:
    std::vector<std::uint8_t> bytes_;
};

/// Reads forward; throws FileError, naming the file, where bytes are missing.
class ByteReader {
  public:
    ByteReader(std::span<const std::uint8_t> bytes, const std::string& file) : bytes_(bytes), file_(file) {}

    template <typename T>
    requires std::is_arithmetic_v<T> T take() {
        T value;
        std::memcpy(&value, take_bytes(1, sizeof(T)).data(), sizeof(T));
        return value;
    }
    std::string take_text() {
        const auto bytes = take_bytes(take<std::uint64_t>(), 1);
        return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    }
    template <typename T>
    requires std::is_arithmetic_v<T> std::vector<T> take_all(std::uint64_t count) {
        const auto bytes = take_bytes(count, sizeof(T));  // before memory is asked for
        std::vector<T> values(static_cast<std::size_t>(count));
        if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
        return values;
    }
    [[nodiscard]] std::size_t left() const { return bytes_.size(); }

    [[noreturn]] void fail(std::string_view expected, std::string_view found) const {
        throw FileError{expected_found(file_, expected, found)};
    }

  private:
    std::span<const std::uint8_t> take_bytes(std::uint64_t count, std::size_t size) {
        if (count > bytes_.size() / size)
            fail("a whole file",
                 fmt::format("{} bytes where it asks for {} values of {}", bytes_.size(), count, size));
        const auto taken = bytes_.first(static_cast<std::size_t>(count) * size);
        bytes_ = bytes_.subspan(taken.size());
        return taken;
    }

    std::span<const std::uint8_t> bytes_;
    std::string file_;
};

}  // namespace relumine
