// SPDX-License-Identifier: Apache-2.0
// The fuzzed readers. Those that want a file get one in memory.
#include "tests/fuzz/fuzz_targets.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <cstring>
#include <stdexcept>
#include <string>

#include "base/fingerprint.hpp"
#include "film/checkpoint.hpp"
#include "image/byte_image.hpp"
#include "relumine/error.hpp"
#include "relumine/image.hpp"
#include "scene/finish_scene.hpp"
#include "scene/readers.hpp"

namespace relumine::fuzz {
namespace {

/// A file of these bytes without a place on any disk.
class MemoryFile {
  public:
    explicit MemoryFile(Bytes bytes) : descriptor_(memfd_create("fuzz", MFD_CLOEXEC)) {
        if (descriptor_ < 0
            || write(descriptor_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()))
            throw std::runtime_error("memfd_create");
    }
    ~MemoryFile() { close(descriptor_); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

  private:
    int descriptor_;
};

template <typename Read>
void may_refuse(const Read& read) {
    try {
        read();
    } catch (const Error&) {
    }
}

void run_gltf(Bytes bytes) {
    const MemoryFile file(bytes);
    may_refuse([&] { (void)finish_scene(read_gltf(file.path())); });
}

void run_pbrt(Bytes bytes) {
    const MemoryFile file(bytes);
    may_refuse([&] { (void)finish_scene(read_pbrt(file.path())); });
}

void run_mitsuba(Bytes bytes) {
    const MemoryFile file(bytes);
    may_refuse([&] { (void)finish_scene(read_mitsuba(file.path())); });
}

template <auto read>
void run_model(Bytes bytes) {
    const MemoryFile file(bytes);
    std::vector<std::string> warnings;
    may_refuse([&] { (void)finish_scene(stage_model(read(file.path(), warnings))); });
}

void run_picture(Bytes bytes) {
    const MemoryFile file(bytes);
    may_refuse([&] { (void)read_image(file.path()); });
}

void run_texture(Bytes bytes) {
    may_refuse([&] { (void)decode_byte_image(bytes, "texture"); });
}

/// The checksum is made to fit first, or nothing behind it would ever be met.
void run_checkpoint(Bytes bytes) {
    constexpr std::size_t front = 16, back = 8;  // magic and length; checksum
    std::vector<std::uint8_t> forged(bytes.begin(), bytes.end());
    if (forged.size() >= front + back) {
        const std::uint64_t length = forged.size() - front - back;
        std::memcpy(&forged[8], &length, sizeof(length));
        Fingerprint print;
        print.add_bytes(std::as_bytes(std::span(forged).subspan(front, length)));
        const std::uint64_t sum = print.value();
        std::memcpy(&forged[front + length], &sum, sizeof(sum));
    }
    may_refuse([&] { (void)encode_checkpoint(decode_checkpoint(forged, "checkpoint")); });
}

}  // namespace

const std::vector<Target>& targets() {
    static const std::vector<Target> all{{"gltf", run_gltf},           {"pbrt", run_pbrt},
                                         {"mitsuba", run_mitsuba},     {"ply", run_model<read_ply>},
                                         {"obj", run_model<read_obj>}, {"picture", run_picture},
                                         {"texture", run_texture},     {"checkpoint", run_checkpoint}};
    return all;
}

}  // namespace relumine::fuzz
