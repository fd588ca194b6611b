#include "volcal/identify/io/checkpoint_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "volcal/identify/text/temporary_paths.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr std::string_view kCheckpointHead = "volcal-montecarlo-checkpoint-1\n";
constexpr std::size_t kWord = sizeof(std::uint64_t);

std::uint64_t checksum(std::string_view bytes) {
  std::uint64_t hash = 0xCBF29CE484222325U;  // Fowler, Noll and Vo, 1a
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001B3U;
  return hash;
}

std::string word_bytes(std::uint64_t value) {
  std::string bytes(kWord, '\0');
  std::memcpy(bytes.data(), &value, kWord);
  return bytes;
}

std::uint64_t word_at(std::string_view bytes, std::size_t place) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.data() + place, kWord);
  return value;
}

[[noreturn]] void fail_to_write(const std::string& path) {
  throw InputError({path, 0}, "the checkpoint cannot be written",
                   "choose an output folder where there is room and that you may write to");
}

/// Closes the file when it goes.
class OutputDescriptor {
 public:
  explicit OutputDescriptor(const std::string& path)
      : descriptor_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {}
  ~OutputDescriptor() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OutputDescriptor(const OutputDescriptor&) = delete;
  OutputDescriptor& operator=(const OutputDescriptor&) = delete;

  bool write(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return ::fsync(descriptor_) == 0;
  }

 private:
  int descriptor_;
};

}  // namespace

std::string checkpoint_bytes(std::uint64_t fingerprint, const std::string& state) {
  std::string bytes(kCheckpointHead);
  bytes += word_bytes(fingerprint) + state;
  bytes += word_bytes(checksum(bytes));
  return bytes;
}

void write_checkpoint(const std::string& path, std::uint64_t fingerprint, const std::string& state) {
  const std::string temporary = path + ".part";
  std::error_code failure;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder, failure);
  const TemporaryPath known(temporary);
  if (!OutputDescriptor(temporary).write(checkpoint_bytes(fingerprint, state))) {
    std::filesystem::remove(temporary, failure);
    fail_to_write(path);
  }
  const PuttingInPlace placing;
  std::filesystem::rename(temporary, path, failure);
  if (failure) fail_to_write(path);
}

bool has_checkpoint(const std::string& path) {
  std::error_code error;
  return std::filesystem::exists(path, error);
}

std::string checkpoint_state(std::string_view bytes, const std::string& file, std::uint64_t fingerprint) {
  if (!bytes.starts_with(kCheckpointHead)) {
    throw InputError({file, 0}, "the file is not a checkpoint of volcal montecarlo",
                     "move it away, and leave --resume out to begin anew");
  }
  const std::size_t head = kCheckpointHead.size();
  if (bytes.size() < head + 2 * kWord ||
      word_at(bytes, bytes.size() - kWord) != checksum(bytes.substr(0, bytes.size() - kWord))) {
    throw InputError({file, 0}, "the checkpoint is cut off or was changed",
                     "delete it, and leave --resume out to begin anew");
  }
  if (word_at(bytes, head) != fingerprint) {
    throw InputError({file, 0},
                     "the checkpoint belongs to another study: campaign, model, seed, path or sources differ",
                     "give the options of the run that was interrupted, or delete the file to begin anew");
  }
  return std::string(bytes.substr(head + kWord, bytes.size() - head - 2 * kWord));
}

std::string read_checkpoint(const std::string& path, std::uint64_t fingerprint) {
  if (!has_checkpoint(path)) {
    throw InputError({path, 0}, "there is no checkpoint to resume from",
                     "give the -o of the run that was interrupted, or leave --resume out to begin anew");
  }
  require_file(path);
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  return checkpoint_state(bytes, path, fingerprint);
}

void remove_checkpoint(const std::string& path) {
  std::error_code error;
  std::filesystem::remove(path, error);
}

}  // namespace volcal
