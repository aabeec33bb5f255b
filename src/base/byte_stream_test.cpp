// SPDX-License-Identifier: Apache-2.0
// Values as bytes and back; lengths that lie; fingerprints.
#include "base/byte_stream.hpp"

#include <gtest/gtest.h>

#include "base/fingerprint.hpp"

namespace relumine {
namespace {

TEST(ByteStream, BringsBackWhatItTook) {
    ByteWriter out;
    out.put(std::uint32_t{7});
    out.put(-0.0);
    out.put(std::string_view("a name"));
    out.put_all(std::span<const float>(std::vector<float>{1, 2, 3}));
    const std::vector<std::uint8_t> bytes = out.take_bytes();
    ByteReader in(bytes, "file");
    EXPECT_EQ(in.take<std::uint32_t>(), 7u);
    EXPECT_TRUE(std::signbit(in.take<double>()));
    EXPECT_EQ(in.take_text(), "a name");
    EXPECT_EQ(in.take_all<float>(3), (std::vector<float>{1, 2, 3}));
    EXPECT_EQ(in.left(), 0u);
}

TEST(ByteStream, LengthsThatLieAreRefusedBeforeMemoryIsAskedFor) {
    ByteWriter out;
    out.put(std::uint64_t{1} << 62);
    const std::vector<std::uint8_t> bytes = out.take_bytes();
    EXPECT_THROW((void)ByteReader(bytes, "file").take_text(), FileError);
    EXPECT_THROW((void)ByteReader(bytes, "file").take_all<double>(std::uint64_t{1} << 61), FileError);
    EXPECT_THROW((void)ByteReader(bytes, "file").take_all<double>(2), FileError);
}

TEST(Fingerprint, EveryBitCounts) {
    std::vector<std::uint8_t> bytes(37, 0);
    const auto print = [&] {
        Fingerprint p;
        p.add_all(bytes);
        return p.value();
    };
    const std::uint64_t before = print();
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        bytes[bit / 8] ^= static_cast<std::uint8_t>(1 << bit % 8);
        EXPECT_NE(print(), before) << bit;
        bytes[bit / 8] ^= static_cast<std::uint8_t>(1 << bit % 8);
    }
    bytes.push_back(0);
    EXPECT_NE(print(), before);
}

TEST(Fingerprint, WhereOneTextEndsCounts) {
    Fingerprint a, b;
    for (const char* text : {"ab", "c"}) a.add(std::string_view(text));
    for (const char* text : {"a", "bc"}) b.add(std::string_view(text));
    EXPECT_NE(a.value(), b.value());
}

}  // namespace
}  // namespace relumine
