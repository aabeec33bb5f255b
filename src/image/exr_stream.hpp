// SPDX-License-Identifier: Apache-2.0
// OpenEXR's streams over bytes in memory.
#pragma once

#include <ImfIO.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace relumine {

/// Reads from bytes that outlive it.
class ExrInput : public Imf::IStream {
  public:
    ExrInput(std::span<const std::uint8_t> bytes, const std::string& name)
        : Imf::IStream(name.c_str()), bytes_(bytes) {}

    bool read(char* out, int count) override {
        const auto wanted = static_cast<std::size_t>(std::max(count, 0));
        if (position_ > bytes_.size() || wanted > bytes_.size() - position_)
            throw std::runtime_error("an early end");
        std::memcpy(out, bytes_.data() + position_, wanted);
        position_ += wanted;
        return position_ < bytes_.size();
    }
    std::uint64_t tellg() override { return position_; }
    void seekg(std::uint64_t position) override { position_ = position; }

  private:
    std::span<const std::uint8_t> bytes_;
    std::uint64_t position_ = 0;
};

/// Collects the bytes of a file.
class ExrOutput : public Imf::OStream {
  public:
    ExrOutput() : Imf::OStream("memory") {}

    void write(const char* in, int count) override {
        const auto wanted = static_cast<std::size_t>(count);
        if (bytes_.size() < position_ + wanted) bytes_.resize(position_ + wanted);
        std::memcpy(bytes_.data() + position_, in, wanted);
        position_ += wanted;
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override { position_ = position; }
    [[nodiscard]] std::vector<std::uint8_t> take_bytes() { return std::move(bytes_); }

  private:
    std::vector<std::uint8_t> bytes_;
    std::uint64_t position_ = 0;
};

}  // namespace relumine
