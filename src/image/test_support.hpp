// SPDX-License-Identifier: Apache-2.0
// What the tests of this folder share: a folder of their own, sample pictures, the words of an error.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include "base/hash.hpp"
#include "image/picture.hpp"
#include "relumine/error.hpp"

namespace relumine::test {

/// A folder that goes when its test ends.
class Folder {
  public:
    Folder() {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        path_ =
            std::filesystem::temp_directory_path()
            / ("relumine-" + std::to_string(::getpid()) + "-" + info->test_suite_name() + "-" + info->name());
        std::filesystem::create_directories(path_);
    }
    ~Folder() { std::filesystem::remove_all(path_); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }
    [[nodiscard]] std::size_t count_files() const {
        return static_cast<std::size_t>(
            std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator()));
    }

  private:
    std::filesystem::path path_;
};

inline void store(const std::string& path, std::span<const std::uint8_t> bytes) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

inline std::vector<std::uint8_t> load(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline std::vector<std::uint8_t> bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

/// Numbers in [0, 1) that depend on `seed` alone.
inline std::vector<float> noise(std::size_t count, std::uint64_t seed = 1) {
    std::vector<float> values;
    for (std::size_t i = 0; i < count; ++i)
        values.push_back(unit_float(static_cast<std::uint32_t>(hash(seed, i) >> 32)));
    return values;
}

inline Image noise_picture(int width, int height, std::uint64_t seed = 1) {
    return make_picture(width, height, {"R", "G", "B"},
                        noise(static_cast<std::size_t>(3 * width * height), seed));
}

/// The message of the ImageError that `call` throws; fails the test for anything else.
inline std::string image_error(const std::function<void()>& call) {
    try {
        call();
    } catch (const ImageError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "more than one line";
        return error.what();
    } catch (const std::exception& error) {
        ADD_FAILURE() << "not an ImageError: " << error.what();
        return error.what();
    }
    ADD_FAILURE() << "no error";
    return "";
}

inline bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace relumine::test
