// SPDX-License-Identifier: Apache-2.0
// A render that was interrupted, as a file: the film's sums to the bit, what is done, and what it belongs to.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/work_done.hpp"
#include "film/film.hpp"

namespace relumine {

/// Everything that the bits of a picture depend on, by name, such as {"seed", "7"}; in fixed order.
using Identity = std::vector<std::pair<std::string, std::string>>;

struct Checkpoint {
    Identity identity;
    WorkDone work;
    bool prepared = false;           // `work` counts what goes before the tiles of the pass under way
    std::vector<std::uint8_t> done;  // 1: that tile of the pass under way is finished
    FilmState film;
};

[[nodiscard]] std::vector<std::uint8_t> encode_checkpoint(const Checkpoint& checkpoint);

/// Throws FileError, naming `file`, for what is not a checkpoint, or damaged in any way.
[[nodiscard]] Checkpoint decode_checkpoint(std::span<const std::uint8_t> bytes, const std::string& file);

/// Throws FileError that names the first difference.
void check_identity(const Identity& found, const Identity& expected, const std::string& file);

}  // namespace relumine
