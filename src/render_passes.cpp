// SPDX-License-Identifier: Apache-2.0
// Running passes.
#include "render_passes.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/executor.hpp"
#include "base/message.hpp"
#include "relumine/error.hpp"

namespace relumine {
namespace {

/// The crop cut along the full frame's multiples of the tile side, row by row.
std::vector<PixelRect> tiles_of(const PixelRect& window, int tile_side) {
    std::vector<PixelRect> tiles;
    for (int y = window.y0 / tile_side * tile_side; y < window.y1; y += tile_side)
        for (int x = window.x0 / tile_side * tile_side; x < window.x1; x += tile_side)
            tiles.push_back({std::max(x, window.x0), std::max(y, window.y0),
                             std::min(x + tile_side, window.x1), std::min(y + tile_side, window.y1)});
    return tiles;
}

std::uint64_t pixels_of(const PixelRect& rect) {
    return static_cast<std::uint64_t>(rect.width()) * static_cast<std::uint64_t>(rect.height());
}

}  // namespace

std::vector<Pass> passes_of(std::uint32_t samples, const Integrator& integrator) {
    std::vector<Pass> passes;
    for (std::uint32_t done = 0; done < samples;) {
        const std::uint32_t count =
            std::min({std::max(integrator.shortest_pass(), done), integrator.longest_pass(), samples - done});
        passes.push_back({done, count});
        done += count;
    }
    return passes;
}

PassRunner::PassRunner(Integrator& integrator, const PixelRect& window, std::uint32_t samples, int threads,
                       Film& film, Monitor& monitor, Keeper& keeper)
    : integrator_(integrator),
      window_(window),
      threads_(threads),
      film_(film),
      monitor_(monitor),
      keeper_(keeper),
      tiles_(tiles_of(window, integrator.tile_side())),
      passes_(passes_of(samples, integrator)),
      done_(tiles_.size()) {}

void PassRunner::resume(const Checkpoint& checkpoint, const std::string& file) {
    const bool under_way = std::ranges::count(checkpoint.done, 0) < std::ssize(checkpoint.done);
    const bool fits = checkpoint.done.size() == done_.size() && checkpoint.film.passes <= passes_.size()
                      && under_way != checkpoint.film.pending.empty()
                      && under_way != checkpoint.film.pending_samples.empty()
                      && (!under_way || checkpoint.film.passes < passes_.size());
    if (!fits || !film_.restore(checkpoint.film))
        throw FileError{
            expected_found(file,
                           fmt::format("a checkpoint of {} x {} pixels in {} passes over {} tiles",
                                       window_.width(), window_.height(), passes_.size(), tiles_.size()),
                           "another one")};
    done_ = checkpoint.done;
    prepared_ = checkpoint.prepared;
    monitor_.resume(checkpoint.work);
    before_ = checkpoint.work;
}

std::uint64_t PassRunner::work_done() const {
    std::uint64_t work = 0;
    for (std::size_t pass = 0; pass < film_.passes(); ++pass)
        work += pixels_of(window_) * passes_[pass].sample_count;
    if (film_.passes() == passes_.size() || integrator_.works_in_preparation()) return work;
    for (std::size_t i = 0; i < tiles_.size(); ++i)
        if (done_[i] != 0) work += pixels_of(tiles_[i]) * passes_[film_.passes()].sample_count;
    return work;
}

bool PassRunner::run() {
    const Pass& last = passes_.back();
    monitor_.begin_stage("render", pixels_of(window_) * (last.first_sample + last.sample_count), work_done());
    if (film_.passes() > 0 && film_.passes() < passes_.size()) recover();
    bool whole = true;
    while (whole && film_.passes() < passes_.size()) whole = run_pass(passes_[film_.passes()]);
    if (keeper_.active()) keeper_.write(snapshot());
    if (film_.passes() == 0) finish_with_gaps();
    monitor_.end_stage();
    return whole;
}

/// Stopped in the first pass: better some tiles than none.
void PassRunner::finish_with_gaps() {
    film_.finish_pass();
    const std::uint64_t pixels = pixels_of(window_),
                        lit = std::min(film_.samples() / passes_.front().sample_count, pixels);
    if (lit == 0 || lit == pixels) return;  // of nothing at all others speak
    monitor_.warn(fmt::format(
        "stopped in the first pass: {} of {} pixels have no sample and are black{}", pixels - lit, pixels,
        integrator_.works_in_preparation() ? "; --method path has samples everywhere sooner" : ""));
}

Preparation PassRunner::preparation(const Pass& pass) {
    Preparation p;
    p.first_sample = pass.first_sample;
    p.sample_count = pass.sample_count;
    p.threads = threads_;
    p.stop = [this] { return monitor_.stop(); };
    return p;
}

void PassRunner::recover() {
    Preparation p = preparation(passes_.front());
    monitor_.prepare(p, false, [&] { integrator_.recover(p); });  // was counted when it was done first
}

bool PassRunner::run_pass(const Pass& pass) {
    const bool prepared = prepare(pass);
    const bool copies = integrator_.works_in_preparation();
    if (prepared || !copies) {
        render_tiles(pass, copies, true);
    } else if (film_.passes() == 0) {
        render_tiles(pass, true, false);  // what there is to show
    }
    if (std::ranges::find(done_, 0) != done_.end()) return false;
    close_pass();
    return true;
}

/// False where it may have been stopped on the way.
bool PassRunner::prepare(const Pass& pass) {
    const bool counts = !prepared_;  // else an earlier run has counted it
    before_ = monitor_.work();
    Preparation p = preparation(pass);
    if (integrator_.works_in_preparation()) {
        const std::uint64_t done = work_done();
        const auto all = static_cast<double>(pixels_of(window_) * pass.sample_count);
        p.progress = [&, done, all](double share) {
            monitor_.advance(done + static_cast<std::uint64_t>(all * std::min(share, 1.0)), p.rays);
        };
    }
    monitor_.prepare(p, counts, [&] { integrator_.prepare(p); });
    if (monitor_.stop()) return false;
    prepared_ = true;
    return true;
}

/// `marks`: whether the tiles are done by this.
void PassRunner::render_tiles(const Pass& pass, bool even_if_stopped, bool marks) {
    std::vector<std::size_t> to_do;
    for (std::size_t i = 0; i < tiles_.size(); ++i)
        if (done_[i] == 0) to_do.push_back(i);
    const bool counted = integrator_.works_in_preparation();
    parallel_for(threads_, to_do.size(), [&](std::size_t k) {
        if (!even_if_stopped && monitor_.stop()) return;
        const std::size_t i = to_do[k];
        Tile tile = make_tile(tiles_[i], pass.first_sample, pass.sample_count);
        integrator_.render(tile);
        film_.add(tile);
        monitor_.finish_tile(tile, counted ? 0 : pixels_of(tiles_[i]) * pass.sample_count, [&] {
            if (marks) done_[i] = 1;
        });
        if (keeper_.due()) keeper_.write(snapshot());
    });
}

void PassRunner::close_pass() {
    film_.finish_pass();
    std::ranges::fill(done_, std::uint8_t{0});
    prepared_ = false;
    before_ = monitor_.work();
    if (keeper_.due()) keeper_.write(snapshot());
}

Checkpoint PassRunner::snapshot() {
    Checkpoint checkpoint;
    monitor_.locked([&](const WorkDone& work) {
        checkpoint.done = done_;
        checkpoint.prepared = prepared_;
        checkpoint.work = prepared_ ? work : before_;  // a preparation that was stopped will be done again
        checkpoint.work.seconds = work.seconds;
    });
    std::vector<PixelRect> tiles;
    for (std::size_t i = 0; i < tiles_.size(); ++i)
        if (checkpoint.done[i] != 0) tiles.push_back(tiles_[i]);
    checkpoint.film = film_.state(tiles);
    return checkpoint;
}

}  // namespace relumine
