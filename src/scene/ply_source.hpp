// SPDX-License-Identifier: Apache-2.0
// The values behind a PLY header, one after the other: as text, or binary in either byte order.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <span>
#include <string>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/ply_header.hpp"
#include "scene/quote.hpp"

namespace relumine {

/// Numbers separated by white space.
class PlyText {
  public:
    PlyText(std::span<const std::uint8_t> bytes, const std::string& path)
        : at_(reinterpret_cast<const char*>(bytes.data())), end_(at_ + bytes.size()), path_(path) {}

    [[nodiscard]] std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - at_); }
    static std::size_t smallest_size(PlyType) {
        return 2;
    }  // a digit and a separator; the last may lack that

    double next(PlyType type) {
        while (at_ != end_ && is_space(*at_)) line_ += *at_++ == '\n' ? 1u : 0u;
        if (at_ != end_ && *at_ == '+') ++at_;
        return type == PlyType::float32 || type == PlyType::float64
                   ? parse<double>()
                   : static_cast<double>(parse<std::int64_t>());
    }

    [[noreturn]] void refuse(const std::string& expected, const std::string& found) const {
        throw SceneError{
            expected_found(fmt::format("{}: line {} of the data", path_, line_), expected, found)};
    }

  private:
    static bool is_space(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

    template <typename T>
    T parse() {
        T value{};
        const auto [end, error] = std::from_chars(at_, end_, value);
        if (error != std::errc{} || (end != end_ && !is_space(*end)))
            refuse("a number",
                   at_ == end_ ? "the end of the file" : quote({at_, std::find_if(at_, end_, is_space)}));
        at_ = end;
        return value;
    }

    const char* at_;
    const char* end_;
    const std::string& path_;
    std::size_t line_ = 1;
};

/// Values of the header's types, without gaps.
template <std::endian order>
class PlyBinary {
  public:
    PlyBinary(std::span<const std::uint8_t> bytes, const std::string& path) : bytes_(bytes), path_(path) {}

    [[nodiscard]] std::size_t bytes_left() const { return bytes_.size() - at_; }
    static std::size_t smallest_size(PlyType type) { return ply_type_size(type); }

    double next(PlyType type) {
        switch (type) {
            case PlyType::int8:
                return load<std::int8_t>();
            case PlyType::uint8:
                return load<std::uint8_t>();
            case PlyType::int16:
                return load<std::int16_t>();
            case PlyType::uint16:
                return load<std::uint16_t>();
            case PlyType::int32:
                return load<std::int32_t>();
            case PlyType::uint32:
                return load<std::uint32_t>();
            case PlyType::float32:
                return static_cast<double>(load<float>());
            default:
                return load<double>();
        }
    }

    [[noreturn]] void refuse(const std::string& expected, const std::string& found) const {
        throw SceneError{expected_found(fmt::format("{}: byte {} of the data", path_, at_), expected, found)};
    }

  private:
    template <typename T>
    T load() {
        if (bytes_left() < sizeof(T)) refuse("a value", "the end of the file");
        std::array<std::uint8_t, sizeof(T)> raw;
        std::memcpy(raw.data(), bytes_.data() + at_, sizeof(T));
        at_ += sizeof(T);
        if constexpr (order != std::endian::native) std::ranges::reverse(raw);
        return std::bit_cast<T>(raw);
    }

    std::span<const std::uint8_t> bytes_;
    const std::string& path_;
    std::size_t at_ = 0;
};

}  // namespace relumine
