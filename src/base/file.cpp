// SPDX-License-Identifier: Apache-2.0
// Whole files in and out.
#include "base/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "base/message.hpp"
#include "relumine/error.hpp"

namespace relumine {
namespace {

/// A file descriptor that closes itself.
class Descriptor {
  public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() {
        if (fd_ >= 0) ::close(fd_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    [[nodiscard]] int get() const { return fd_; }
    [[nodiscard]] int close() { return ::close(std::exchange(fd_, -1)); }

  private:
    int fd_;
};

[[noreturn]] void fail_reading(const std::string& path, const std::string& found) {
    throw FileError{expected_found(path, "a readable file", found)};
}

/// Bytes of a regular file; fails for folders, devices and files over the limit.
std::size_t checked_size(const Descriptor& file, const std::string& path, std::size_t limit) {
    struct stat status {};
    if (::fstat(file.get(), &status) != 0) fail_reading(path, std::strerror(errno));
    if (S_ISDIR(status.st_mode)) fail_reading(path, "a folder");
    if (!S_ISREG(status.st_mode)) fail_reading(path, "something that is not a regular file");
    const auto size = static_cast<std::size_t>(status.st_size);
    if (size > limit)
        throw FileError{
            expected_found(path, fmt::format("at most {} bytes", limit), fmt::format("{}", size))};
    return size;
}

void write_all(const Descriptor& file, std::span<const std::uint8_t> bytes, const std::string& path) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(file.get(), bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) throw OutputError{fmt::format("{}: cannot write: {}", path, std::strerror(errno))};
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
}

/// Inflates one or more gzip members.
class Inflater {
  public:
    explicit Inflater(const std::string& path) : path_(path) {
        constexpr int window_bits_with_gzip_header = 15 + 16;
        if (inflateInit2(&stream_, window_bits_with_gzip_header) != Z_OK) fail("zlib that starts");
    }
    ~Inflater() { inflateEnd(&stream_); }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;

    std::vector<std::uint8_t> unpack(std::span<const std::uint8_t> packed, std::size_t limit) {
        std::vector<std::uint8_t> out;
        const std::uint8_t* next = packed.data();
        std::size_t left = packed.size();
        int status = Z_OK;
        while (status != Z_STREAM_END) {
            refill(next, left);
            grow(out, limit);
            status = inflate(&stream_, Z_NO_FLUSH);
            out.resize(out.size() - stream_.avail_out);
            if (status == Z_STREAM_END && (left > 0 || stream_.avail_in > 0)) status = inflateReset(&stream_);
            if (status != Z_OK && status != Z_STREAM_END) fail("an undamaged gzip stream");
        }
        return out;
    }

  private:
    void refill(const std::uint8_t*& next, std::size_t& left) {
        if (stream_.avail_in > 0) return;
        const auto chunk = static_cast<uInt>(std::min<std::size_t>(left, std::size_t{1} << 30));
        if (chunk == 0) fail("a whole gzip stream");
        stream_.next_in = const_cast<Bytef*>(next);  // zlib's interface is not const-correct; it only reads
        stream_.avail_in = chunk;
        next += chunk;
        left -= chunk;
    }
    void grow(std::vector<std::uint8_t>& out, std::size_t limit) {
        const std::size_t had = out.size();
        if (had >= limit) fail(fmt::format("at most {} bytes when unpacked", limit));
        out.resize(
            std::min({had + std::max(had, std::size_t{1} << 16), had + (std::size_t{1} << 30), limit}));
        stream_.next_out = out.data() + had;
        stream_.avail_out = static_cast<uInt>(out.size() - had);
    }
    [[noreturn]] void fail(const std::string& expected) const {
        throw FileError{
            expected_found(path_, expected, stream_.msg ? stream_.msg : "an early end or too much data")};
    }

    z_stream stream_{};
    std::string path_;
};

}  // namespace

std::vector<std::uint8_t> read_file(const std::string& path, std::size_t limit) {
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (file.get() < 0) fail_reading(path, std::strerror(errno));
    std::vector<std::uint8_t> bytes(checked_size(file, path, limit));
    std::size_t have = 0;
    while (have < bytes.size()) {
        const ssize_t got = ::read(file.get(), bytes.data() + have, bytes.size() - have);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) fail_reading(path, std::strerror(errno));
        if (got == 0) break;
        have += static_cast<std::size_t>(got);
    }
    bytes.resize(have);
    return bytes;
}

bool is_gzip(std::span<const std::uint8_t> bytes) {
    return bytes.size() >= 2 && bytes[0] == 0x1f && bytes[1] == 0x8b;
}

std::vector<std::uint8_t> unpack_gzip(std::span<const std::uint8_t> packed, const std::string& path,
                                      std::size_t limit) {
    return Inflater(path).unpack(packed, limit);
}

void write_file_atomically(const std::string& path, std::span<const std::uint8_t> bytes,
                           const std::string& unfinished_name) {
    const std::string unfinished =
        unfinished_name.empty() ? fmt::format("{}.{}.unfinished", path, ::getpid()) : unfinished_name;
    Descriptor file(::open(unfinished.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
    if (file.get() < 0) throw OutputError{fmt::format("{}: cannot create: {}", path, std::strerror(errno))};
    try {
        write_all(file, bytes, path);
        if (::fsync(file.get()) != 0 || file.close() != 0
            || std::rename(unfinished.c_str(), path.c_str()) != 0)
            throw OutputError{fmt::format("{}: cannot finish: {}", path, std::strerror(errno))};
    } catch (...) {
        ::unlink(unfinished.c_str());
        throw;
    }
}

}  // namespace relumine
