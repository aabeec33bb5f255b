// SPDX-License-Identifier: Apache-2.0
// Checkpoints: back to the bit, or refused with the reason.
#include "film/checkpoint.hpp"

#include <gtest/gtest.h>

#include "base/fingerprint.hpp"
#include "relumine/error.hpp"

namespace relumine {
namespace {

Checkpoint some_checkpoint() {
    Checkpoint c;
    c.identity = {{"seed", "7"}, {"method", "path"}};
    c.work.rays.add(RayPurpose::shadow, 12);
    c.work.cache.records = 3;
    c.work.cache.nanoseconds[2] = 5;
    c.work.non_finite = 2;
    c.work.first_non_finite = SampleId{3, 4, 5};
    c.work.seconds = 1.5;
    c.prepared = true;
    c.done = {1, 0, 1};
    c.film = {2, {1, -0.0f, 3e-42f}, {4, 5, 6}, {1, 2, 1}, {1, 0, 1}};
    return c;
}

std::string message_of(const std::vector<std::uint8_t>& bytes) {
    try {
        (void)decode_checkpoint(bytes, "c.ckpt");
    } catch (const FileError& error) {
        return error.what();
    }
    return "";
}

TEST(Checkpoint, ComesBackToTheBit) {
    const std::vector<std::uint8_t> bytes = encode_checkpoint(some_checkpoint());
    const Checkpoint back = decode_checkpoint(bytes, "c.ckpt");
    EXPECT_EQ(encode_checkpoint(back), bytes);
    EXPECT_EQ(back.identity, some_checkpoint().identity);
    EXPECT_EQ(back.work.first_non_finite, (SampleId{3, 4, 5}));
    EXPECT_TRUE(std::signbit(back.film.finished[1]));
    EXPECT_EQ(back.film.finished[2], 3e-42f);
}

TEST(Checkpoint, EveryDamagedByteIsRefused) {
    const std::vector<std::uint8_t> bytes = encode_checkpoint(some_checkpoint());
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        std::vector<std::uint8_t> damaged = bytes;
        damaged[i] ^= 0x40;
        EXPECT_NE(message_of(damaged).find("c.ckpt: expected "), std::string::npos) << "byte " << i;
    }
}

TEST(Checkpoint, EveryTruncationIsRefused) {
    const std::vector<std::uint8_t> bytes = encode_checkpoint(some_checkpoint());
    for (std::size_t size = 0; size < bytes.size(); ++size)
        EXPECT_NE(message_of({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}), "") << size;
    std::vector<std::uint8_t> longer = bytes;
    longer.push_back(0);
    EXPECT_NE(message_of(longer), "");
}

/// The checksum guards against accidents alone: what it covers is read as if it came from a stranger.
TEST(Checkpoint, LengthsThatLieUnderAGoodChecksumAreRefused) {
    const std::vector<std::uint8_t> bytes = encode_checkpoint(some_checkpoint());
    constexpr std::size_t frame = 16;  // magic, length
    for (std::size_t i = frame; i + 8 < bytes.size(); ++i) {
        std::vector<std::uint8_t> forged = bytes;
        forged[i] = 0xff;
        Fingerprint print;
        print.add_bytes(std::as_bytes(std::span(forged).subspan(frame, forged.size() - frame - 8)));
        const std::uint64_t sum = print.value();
        std::memcpy(&forged[forged.size() - 8], &sum, sizeof(sum));
        try {
            (void)decode_checkpoint(forged, "c.ckpt");  // either is fine, but nothing else
        } catch (const FileError&) {
        }
    }
}

TEST(Checkpoint, TheDifferenceIsNamed) {
    const Identity mine{{"version", "0.1.0"}, {"seed", "7"}};
    const auto message = [&](const Identity& found) -> std::string {
        try {
            check_identity(found, mine, "c.ckpt");
        } catch (const FileError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(message(mine), "");
    EXPECT_EQ(message({{"version", "0.1.0"}, {"seed", "8"}}),
              "c.ckpt: seed of the checkpoint: expected \"7\" as in this render, found \"8\"");
    EXPECT_EQ(message({{"version", "0.1.0"}}),
              "c.ckpt: seed of the checkpoint: expected \"7\" as in this render, found none");
    EXPECT_NE(message({{"version", "0.1.0"}, {"seed", "7"}, {"error", "1"}}), "");
}

}  // namespace
}  // namespace relumine
