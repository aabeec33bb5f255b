// SPDX-License-Identifier: Apache-2.0
// Checkpoints: magic, length, what it says, checksum.
#include "film/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/byte_stream.hpp"
#include "base/fingerprint.hpp"

namespace relumine {
namespace {

constexpr std::uint64_t magic = 0x3130506b434d4c52;     // "RLMCkP01": changes with the layout of the file
constexpr std::size_t frame_bytes = 3 * sizeof(magic);  // magic and length in front, checksum behind

std::uint64_t checksum(std::span<const std::uint8_t> bytes) {
    Fingerprint print;
    print.add_bytes(std::as_bytes(bytes));
    return print.value();
}

template <typename T>
void put_counted(ByteWriter& out, const std::vector<T>& values) {
    out.put(std::uint64_t{values.size()});
    out.put_all(std::span<const T>(values));
}
template <typename T>
std::vector<T> take_counted(ByteReader& in) {
    return in.take_all<T>(in.take<std::uint64_t>());
}

template <std::size_t size>
void take_counters(ByteReader& in, std::array<std::uint64_t, size>& counters) {
    const auto values = take_counted<std::uint64_t>(in);
    if (values.size() != size) in.fail(fmt::format("{} counters", size), fmt::format("{}", values.size()));
    std::ranges::copy(values, counters.begin());
}
template <std::size_t size>
void put_counters(ByteWriter& out, const std::array<std::uint64_t, size>& counters) {
    out.put(std::uint64_t{size});
    out.put_all(std::span<const std::uint64_t>(counters));
}

/// The members of CacheCounts that are single numbers.
template <typename Counts>
auto single_counts(Counts& c) {
    return std::array{&c.records, &c.surfels, &c.record_bytes, &c.points, &c.reprojections, &c.gathered};
}

void put_work(ByteWriter& out, const WorkDone& work) {
    put_counters(out, work.rays.by_purpose);
    out.put(work.rays.non_finite);
    for (const std::uint64_t* count : single_counts(work.cache)) out.put(*count);
    put_counters(out, work.cache.nanoseconds);
    out.put(work.non_finite);
    out.put(static_cast<std::uint8_t>(work.first_non_finite.has_value()));
    const SampleId first = work.first_non_finite.value_or(SampleId{});
    out.put(std::int32_t{first.x});
    out.put(std::int32_t{first.y});
    out.put(first.sample);
    out.put(work.seconds);
}

WorkDone take_work(ByteReader& in) {
    WorkDone work;
    take_counters(in, work.rays.by_purpose);
    work.rays.non_finite = in.take<std::uint64_t>();
    for (std::uint64_t* count : single_counts(work.cache)) *count = in.take<std::uint64_t>();
    take_counters(in, work.cache.nanoseconds);
    work.non_finite = in.take<std::uint64_t>();
    const bool any = in.take<std::uint8_t>() != 0;
    SampleId first;
    first.x = in.take<std::int32_t>();
    first.y = in.take<std::int32_t>();
    first.sample = in.take<std::uint32_t>();
    if (any) work.first_non_finite = first;
    work.seconds = in.take<double>();
    return work;
}

void put_film(ByteWriter& out, const FilmState& film) {
    out.put(film.passes);
    put_counted(out, film.finished);
    put_counted(out, film.finished_samples);
    put_counted(out, film.pending);
    put_counted(out, film.pending_samples);
}

FilmState take_film(ByteReader& in) {
    FilmState film;
    film.passes = in.take<std::uint32_t>();
    film.finished = take_counted<float>(in);
    film.finished_samples = take_counted<std::uint32_t>(in);
    film.pending = take_counted<float>(in);
    film.pending_samples = take_counted<std::uint32_t>(in);
    return film;
}

Identity take_identity(ByteReader& in) {
    const auto count = in.take<std::uint64_t>();
    Identity identity;
    for (std::uint64_t i = 0; i < count; ++i) {
        std::string name = in.take_text();  // throws where the file ends: no count is believed
        identity.emplace_back(std::move(name), in.take_text());
    }
    return identity;
}

/// What lies between the frame of magic, length and checksum.
std::span<const std::uint8_t> checked_payload(std::span<const std::uint8_t> bytes, const std::string& file) {
    ByteReader head(bytes, file);
    if (bytes.size() < frame_bytes || head.take<std::uint64_t>() != magic)
        head.fail("a checkpoint of this version of Relumine", "something else");
    const auto length = head.take<std::uint64_t>();
    if (length != bytes.size() - frame_bytes)
        head.fail(fmt::format("a whole checkpoint of {} bytes", length),
                  fmt::format("{} bytes", bytes.size() - frame_bytes));
    const auto payload = bytes.subspan(2 * sizeof(magic), static_cast<std::size_t>(length));
    ByteReader tail(bytes.last(sizeof(magic)), file);
    if (tail.take<std::uint64_t>() != checksum(payload))
        head.fail("an undamaged checkpoint", "a checksum that does not fit");
    return payload;
}

}  // namespace

std::vector<std::uint8_t> encode_checkpoint(const Checkpoint& c) {
    ByteWriter payload;
    const std::size_t pixels = c.film.finished_samples.size() + c.film.pending_samples.size();
    payload.reserve((std::size_t{1} << 16)
                    + sizeof(float) * (pixels + c.film.finished.size() + c.film.pending.size()));
    payload.put(magic);
    payload.put(std::uint64_t{0});  // the length, below
    payload.put(std::uint64_t{c.identity.size()});
    for (const auto& [name, value] : c.identity) {
        payload.put(name);
        payload.put(value);
    }
    put_work(payload, c.work);
    payload.put(static_cast<std::uint8_t>(c.prepared));
    put_counted(payload, c.done);
    put_film(payload, c.film);
    std::vector<std::uint8_t> bytes = payload.take_bytes();
    const std::uint64_t length = bytes.size() - 2 * sizeof(magic);
    std::memcpy(bytes.data() + sizeof(magic), &length, sizeof(length));
    const std::uint64_t sum = checksum(std::span(bytes).subspan(2 * sizeof(magic)));
    const auto* sum_bytes = reinterpret_cast<const std::uint8_t*>(&sum);
    bytes.insert(bytes.end(), sum_bytes, sum_bytes + sizeof(sum));
    return bytes;
}

Checkpoint decode_checkpoint(std::span<const std::uint8_t> bytes, const std::string& file) {
    ByteReader in(checked_payload(bytes, file), file);
    Checkpoint c;
    c.identity = take_identity(in);
    c.work = take_work(in);
    c.prepared = in.take<std::uint8_t>() != 0;
    c.done = take_counted<std::uint8_t>(in);
    c.film = take_film(in);
    if (in.left() > 0) in.fail("the end of the checkpoint", fmt::format("{} more bytes", in.left()));
    return c;
}

void check_identity(const Identity& found, const Identity& expected, const std::string& file) {
    for (const auto& [name, value] : expected) {
        const auto same_name = std::ranges::find(found, name, &Identity::value_type::first);
        const std::string there = same_name == found.end() ? "none" : "\"" + same_name->second + "\"";
        if (same_name == found.end() || same_name->second != value)
            throw FileError{expected_found(fmt::format("{}: {} of the checkpoint", file, name),
                                           "\"" + value + "\" as in this render", there)};
    }
    if (found.size() != expected.size())
        throw FileError{expected_found(file, fmt::format("a checkpoint of {} inputs", expected.size()),
                                       fmt::format("{}", found.size()))};
}

}  // namespace relumine
