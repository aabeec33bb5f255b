// SPDX-License-Identifier: Apache-2.0
// Watching a render.
#include "render_monitor.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

namespace relumine {
namespace {

double cpu_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::uint64_t peak_memory_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

CacheStats cache_stats(const CacheCounts& c) {
    CacheStats stats{c.records, c.surfels, c.record_bytes, c.points, c.reprojections, c.gathered, {}};
    for (std::size_t i = 0; i < cache_step_names.size(); ++i)
        stats.cpu_seconds.emplace_back(cache_step_names[i], 1e-9 * static_cast<double>(c.nanoseconds[i]));
    return stats;
}

/// For whom it may concern: running out of memory is refused by name and is no way to end well.
std::string name_of(StopReason reason) {
    if (reason == StopReason::observer) return "observer";
    if (reason == StopReason::time) return "time limit";
    return reason == StopReason::memory ? "memory limit" : "";
}

}  // namespace

std::uint64_t resident_bytes() {
    std::ifstream file("/proc/self/statm");
    std::uint64_t all = 0, resident = 0;  // pages
    if (!(file >> all >> resident)) return 0;
    return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

Monitor::Monitor(RenderObserver* observer, const RenderControl& control)
    : observer_(observer),
      time_limit_(control.time_limit),
      memory_limit_(control.memory_limit),
      cpu_begin_(cpu_seconds()) {}

double Monitor::seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

void Monitor::begin_stage(const std::string& name, std::uint64_t total, std::uint64_t done) {
    end_stage();
    stage_ = {name, done, total, work_.rays.total(), seconds(), -1};
    stage_begin_ = seconds();
    done_before_ = done;
    if (observer_) observer_->progress(stage_);
}

void Monitor::end_stage() {
    if (!stage_.stage.empty()) stages_.emplace_back(stage_.stage, seconds() - stage_begin_);
    stage_.stage.clear();
}

StopReason Monitor::reason_to_stop() {
    if (observer_ && observer_->stop_requested()) return StopReason::observer;
    if (time_limit_ <= 0 && memory_limit_ == 0) return StopReason::none;
    const double now = seconds();
    if (time_limit_ > 0 && now >= time_limit_) return StopReason::time;
    if (memory_limit_ == 0 || now < next_memory_check_) return StopReason::none;
    constexpr double pause = 0.05;  // seconds between looks at the memory
    next_memory_check_ = now + pause;
    return resident_bytes() > memory_limit_ ? StopReason::memory : StopReason::none;
}

bool Monitor::stop() {
    if (reason_ != StopReason::none) return true;
    const std::lock_guard lock(mutex_);
    if (reason_ == StopReason::none) reason_ = reason_to_stop();
    return reason_ != StopReason::none;
}

void Monitor::tell_progress() {
    stage_.seconds = seconds();
    const auto done_now = static_cast<double>(stage_.done - done_before_);
    if (done_now > 0)
        stage_.seconds_left =
            (stage_.seconds - stage_begin_) * static_cast<double>(stage_.total - stage_.done) / done_now;
    observer_->progress(stage_);
}

void Monitor::finish_tile(const Tile& tile, std::uint64_t work, const std::function<void()>& mark) {
    const std::lock_guard lock(mutex_);
    work_.add(tile);
    mark();
    stage_.done += work;
    if (!observer_) return;
    stage_.rays = work_.rays.total();
    observer_->tile_finished(tile.rect);
    tell_progress();
}

void Monitor::advance(std::uint64_t done, const RayCounts& under_way) {
    const std::lock_guard lock(mutex_);
    stage_.done = done;
    if (!observer_) return;
    stage_.rays = work_.rays.total() + under_way.total();
    tell_progress();
}

void Monitor::prepare(Preparation& p, bool counts, const std::function<void()>& work) {
    const double begin = seconds();
    work();
    preparation_seconds_ += seconds() - begin;
    if (!counts) return;
    const std::lock_guard lock(mutex_);
    work_.rays.add(p.rays);
    work_.cache.add(p.counts);
    work_.add(p.dropped.non_finite, p.dropped.first_non_finite);
}

void Monitor::add(const RayCounts& rays) {
    const std::lock_guard lock(mutex_);
    work_.rays.add(rays);
}

void Monitor::resume(const WorkDone& earlier) {
    work_ = earlier;
    earlier_seconds_ = earlier.seconds;
}

WorkDone Monitor::work() {
    WorkDone copy;
    locked([&](const WorkDone& work) { copy = work; });
    return copy;
}

void Monitor::locked(const std::function<void(const WorkDone&)>& use) {
    const std::lock_guard lock(mutex_);
    work_.seconds = earlier_seconds_ + seconds();
    use(work_);
}

void Monitor::warn(const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (observer_) observer_->warning(text);
}

RenderStats Monitor::stats(int threads) {
    end_stage();
    RenderStats stats;
    stats.stage_seconds = stages_;
    if (work_.cache.points + work_.cache.gathered > 0) {
        stats.stage_seconds.back().second -= preparation_seconds_;
        stats.stage_seconds.insert(stats.stage_seconds.end() - 1, {"records", preparation_seconds_});
        stats.cache = cache_stats(work_.cache);
    }
    stats.total_seconds = seconds();
    stats.cpu_seconds = cpu_seconds() - cpu_begin_;
    for (std::size_t i = 0; i < ray_purpose_names.size(); ++i)
        stats.rays[ray_purpose_names[i]] = work_.rays.by_purpose[i];
    stats.total_rays = work_.rays.total();
    stats.non_finite_samples = work_.non_finite;
    stats.non_finite_rays = work_.rays.non_finite;
    if (const auto& first = work_.first_non_finite)
        stats.first_non_finite = {first->x, first->y, first->sample};
    stats.peak_memory_bytes = peak_memory_bytes();
    stats.threads = threads;
    stats.stopped = reason_ != StopReason::none;
    stats.stopped_by = name_of(reason_);
    return stats;
}

}  // namespace relumine
