// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/files.h"

#include "base/error.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <system_error>
#include <utility>

namespace isophote {
namespace {

namespace fs = std::filesystem;

std::string reason(int code) { return std::generic_category().message(code); }

class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() { close(); }
  Descriptor(Descriptor&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(value_, other.value_);
    return *this;
  }
  int get() const { return value_; }
  bool valid() const { return value_ >= 0; }
  /// False where the system reports late that bytes were lost.
  bool close() {
    const int closing = std::exchange(value_, -1);
    return closing < 0 || ::close(closing) == 0;
  }

 private:
  int value_;
};

/// Where a write to `path` really goes: through symbolic links, so that renaming replaces the file, not the
/// link.
fs::path destination(const fs::path& path) {
  std::error_code ignored;
  const fs::path resolved = fs::is_symlink(path, ignored) ? fs::weakly_canonical(path, ignored) : path;
  return resolved.empty() ? path : resolved;
}

/// A device, pipe or socket: it is written to as it is, never replaced.
bool isStream(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

/// A name beside `target` that nobody else uses.
fs::path nameBeside(const fs::path& target) {
  static std::atomic<unsigned> counter{0};  // Only makes names differ within this process.
  fs::path name = target;
  name.replace_filename(fmt::format(".{}.{}-{}.tmp", target.filename().string(), getpid(), counter++));
  return name;
}

/// Creates a file beside `target`; `temporary` receives its name.
int createBeside(const fs::path& target, fs::path& temporary) {
  for (int attempt = 0; attempt < 100; ++attempt) {
    temporary = nameBeside(target);
    const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0 || errno != EEXIST) return file;
  }
  return -1;
}

/// Creates a file without a name in the folder of `target`: nothing is left of it should the process end. Not
/// every file system can.
int createUnnamed(const fs::path& target) {
  if (::access("/proc/self/fd", X_OK) != 0) return -1;  // By which giveName() finds it again.
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  return ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
}

[[noreturn]] void failToWrite(const fs::path& path, int code) {
  if (code == ENOSPC || code == EDQUOT)
    fail(ErrorKind::kResources, path.string(),
         "cannot be written: {}; free some space or choose another disk", reason(code));
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) failInput(path.string(), "is a folder; give the name of a file in it");
  if (!fs::exists(folder, ignored))
    failInput(path.string(), "cannot be written because the folder \"{}\" does not exist; create it first",
              folder.string());
  failInput(path.string(), "cannot be written: {}; choose a file in a folder that you may write to",
            reason(code));
}

bool writeAll(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written =
        ::write(file, bytes.data(), std::min<std::size_t>(bytes.size(), std::size_t(1) << 30));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes.remove_prefix(std::size_t(written));
  }
  return true;
}

/// Gives a file without a name one beside `target`, which `temporary` receives.
bool giveName(int file, const fs::path& target, fs::path& temporary) {
  const std::string self = fmt::format("/proc/self/fd/{}", file);
  for (int attempt = 0; attempt < 100; ++attempt) {
    const fs::path name = nameBeside(target);
    if (::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0) {
      temporary = name;
      return true;
    }
    if (errno != EEXIST) return false;
  }
  return false;
}

}  // namespace

std::string readFile(const fs::path& path, std::uint64_t maxBytes) {
  // Not blocking: opening a pipe would wait for whoever writes to it.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file.valid()) {
    if (errno == ENOENT) failInput(path.string(), "does not exist");
    failInput(path.string(), "cannot be read: {}", reason(errno));
  }
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) failInput(path.string(), "cannot be read: {}", reason(errno));
  if (S_ISDIR(info.st_mode)) failInput(path.string(), "is a folder, not a file");
  if (!S_ISREG(info.st_mode)) failInput(path.string(), "is a device or pipe; copy what it gives to a file");
  std::string bytes;
  bytes.reserve(std::min<std::uint64_t>(std::uint64_t(std::max<off_t>(info.st_size, 0)), maxBytes));
  char block[1 << 16];
  for (;;) {
    const ssize_t count = ::read(file.get(), block, sizeof block);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) failInput(path.string(), "cannot be read: {}", reason(errno));
    if (count == 0) return bytes;
    if (bytes.size() + std::size_t(count) > maxBytes)
      failInput(path.string(), "holds more than {} bytes, the most that is read here", maxBytes);
    bytes.append(block, std::size_t(count));
  }
}

void writeFileAtomically(const fs::path& path, std::string_view bytes) {
  const fs::path target = destination(path);
  std::error_code ignored;
  if (fs::is_directory(target, ignored)) failToWrite(path, EISDIR);
  if (isStream(target)) {
    Descriptor stream(::open(target.c_str(), O_WRONLY | O_CLOEXEC));
    if (!stream.valid() || !writeAll(stream.get(), bytes) || !stream.close()) failToWrite(path, errno);
    return;
  }
  fs::path temporary;
  Descriptor file(createUnnamed(target));
  const bool named = !file.valid();
  if (named) file = Descriptor(createBeside(target, temporary));
  if (!file.valid()) failToWrite(path, errno);
  bool written = writeAll(file.get(), bytes);
  if (written && !named) written = giveName(file.get(), target, temporary);
  if (!written || !file.close() || ::rename(temporary.c_str(), target.c_str()) != 0) {
    const int code = errno;
    if (!temporary.empty()) ::unlink(temporary.c_str());
    failToWrite(path, code);
  }
}

void writeFileAtomically(const fs::path& path, std::span<const std::uint8_t> bytes) {
  writeFileAtomically(path, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void requireWritable(const fs::path& path) {
  const fs::path target = destination(path);
  std::error_code ignored;
  if (path.empty()) failInput("", "the name of the file to write is empty");
  if (fs::is_directory(target, ignored)) failToWrite(path, EISDIR);
  if (isStream(target)) {
    if (::access(target.c_str(), W_OK) != 0) failToWrite(path, errno);
    return;
  }
  fs::path temporary;
  Descriptor file(createBeside(target, temporary));
  if (!file.valid()) failToWrite(path, errno);
  ::unlink(temporary.c_str());
}

}  // namespace isophote
