#include "bench/studies/trade/journal_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "base/user_error.h"
#include "hw/wire/crc32c.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

/// Of all journals, whatever their schema.
constexpr std::string_view kStart = R"({"schema":"wobblebench.)";
constexpr std::size_t kChecksumBytes = sizeof(R"(,"crc32c":"00000000"})") - 1;

/// Why a journal is not taken: a reason without the name of its file.
struct Fault {
  std::string reason;
};

/// What stands in place of the closing brace of `object`, JSON's text of an object.
std::string checksum_of(std::string_view object) {
  std::array<char, kChecksumBytes + 1> text{};
  const std::uint32_t crc = hw::crc32c(std::as_bytes(std::span(object)));
  std::snprintf(text.data(), text.size(), R"(,"crc32c":"%08x"})", static_cast<unsigned>(crc));
  return text.data();
}

std::string with_checksum(const Json& line) {
  std::string text = line.dump();
  const std::string checksum = checksum_of(text);
  text.pop_back();
  return text + checksum + "\n";
}

/// The text that with_checksum() was given; nullopt: this line is none of its, or was changed.
std::optional<std::string> without_checksum(std::string_view line) {
  if (line.size() <= kChecksumBytes) return std::nullopt;
  std::string object(line.substr(0, line.size() - kChecksumBytes));
  object += '}';
  if (line.substr(line.size() - kChecksumBytes) != checksum_of(object)) return std::nullopt;
  return object;
}

Json json_of(const JournalHead& head) {
  return {{"schema", head.schema}, {"plan", head.plan}};
}

struct Content {
  std::set<std::string> machines;
  std::size_t measurements = 0;
  std::size_t whole = 0;  ///< bytes up to the end of the last whole line
};

/// Reads the text of a journal.
class LineReader {
 public:
  LineReader(const JournalHead& head, const TakeLine& take) : head_(head), take_(take) {}

  /// Throws Fault.
  Content read(const std::string& text) {
    Content content;
    const std::size_t end = text.rfind('\n') + 1;  // 0: there is no whole line
    if (end == 0 && !text.starts_with(kStart) && !kStart.starts_with(text)) {
      throw Fault{"is no journal of measurements"};
    }
    for (std::size_t at = 0; at < end;) {
      const std::size_t stop = text.find('\n', at);
      take_line(std::string_view(text).substr(at, stop - at), content);
      at = stop + 1;
    }
    if (content.measurements == 0) return {};
    if (!is_of_version_) throw Fault{"was written by another version of the program"};
    if (!is_of_plan_) throw Fault{"holds the points of another plan"};
    content.whole = end;
    return content;
  }

 private:
  void take_line(std::string_view line, Content& content) {
    ++number_;
    const auto object = without_checksum(line);
    if (!object) refuse_line(line);
    if (number_ == 1) {
      is_of_plan_ = *object == json_of(head_).dump();
      is_of_version_ = object->find('"' + head_.schema + '"') != std::string_view::npos;
      if (!object->starts_with(kStart)) throw Fault{"is no journal of measurements"};
      return;
    }
    try {
      const Json json = Json::parse(*object);
      if (json.contains("machine")) {
        content.machines.insert(json["machine"].get<std::string>());
        return;
      }
      ++content.measurements;
      if (is_of_plan_) take_(json);
    } catch (const Json::exception&) {
      throw Fault{"line " + std::to_string(number_) + " is no measured point"};
    }
  }

  [[noreturn]] void refuse_line(std::string_view line) const {
    if (number_ > 1) {
      throw Fault{
          "line " + std::to_string(number_) +
          " is damaged: its checksum does not hold; without that line the rest can be used"};
    }
    const bool is_old = line.starts_with(kStart) && line.find("crc32c") == std::string_view::npos;
    throw Fault{is_old ? "was written by an earlier version, whose lines have no checksum"
                : line.starts_with(kStart) ? "line 1 is damaged: its checksum does not hold"
                                           : "is no journal of measurements"};
  }

  const JournalHead& head_;
  const TakeLine& take_;
  int number_ = 0;
  bool is_of_plan_ = false;
  bool is_of_version_ = false;
};

/// Not open: there is no such file. Does not wait for the other end of a FIFO. Throws Fault.
FileDescriptor open_regular(const std::filesystem::path& path, int flags) {
  FileDescriptor file(::open(path.c_str(), flags | O_CLOEXEC | O_NONBLOCK));
  if (!file.is_open() && errno == ENOENT) return file;
  if (!file.is_open() && errno == ELOOP) throw Fault{"is a symbolic link"};
  if (!file.is_open() && errno == EISDIR) throw Fault{"is a folder"};
  if (!file.is_open() && errno == ENXIO) throw Fault{"is no regular file"};
  if (!file.is_open()) throw Fault{std::string("cannot be opened: ") + std::strerror(errno)};
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) throw Fault{std::strerror(errno)};
  if (S_ISDIR(status.st_mode)) throw Fault{"is a folder"};
  if (!S_ISREG(status.st_mode)) throw Fault{"is no regular file"};
  const bool is_written = (flags & O_ACCMODE) != O_RDONLY;
  if (is_written && status.st_nlink > 1)
    throw Fault{"is a hard link, another name of which exists"};
  return file;
}

}  // namespace

JournalFile::JournalFile(const std::filesystem::path& folder,
                         const JournalHead& head,
                         const TakeLine& take)
    : path_(folder / head.file), head_(head) {
  try {
    file_ = open_regular(path_, O_RDWR | O_APPEND | O_NOFOLLOW);
    if (!file_.is_open()) return;
    Content content = LineReader(head_, take).read(read_file(file_, path_));
    machines_ = std::move(content.machines);
    whole_ = content.whole;
    kept_ = content.measurements;
  } catch (const Fault& fault) {
    throw UserError("--out = " + folder.string() + ": its " + head.file + " " + fault.reason +
                    "; give another folder");
  }
}

/// Behind what counts; a new file gets its head.
void JournalFile::begin() {
  const bool is_new = !file_.is_open();
  if (is_new) {
    constexpr int kNew = O_CREAT | O_EXCL | O_NOFOLLOW;
    file_ = FileDescriptor(::open(path_.c_str(), kNew | O_RDWR | O_APPEND | O_CLOEXEC, 0666));
  }
  if (!file_.is_open() || ::ftruncate(file_.get(), static_cast<off_t>(whole_)) != 0) {
    throw std::runtime_error(path_.string() + ": cannot be written: " + std::strerror(errno));
  }
  begun_ = true;
  if (whole_ == 0) write(json_of(head_));
  if (is_new) sync_folder(path_.parent_path());
}

void JournalFile::write(const Json& line) {
  if (write_all(file_.get(), with_checksum(line)) && sync_data(file_.get()) == 0) return;
  throw std::runtime_error(path_.string() + ": cannot be written: " + std::strerror(errno));
}

void JournalFile::say_kept() const {
  if (kept_ == 0) return;
  std::cerr << "wobblebench: went on with " << kept_
            << (kept_ == 1 ? " measurement" : " measurements") << " that " << path_.string()
            << " holds\n";
}

void JournalFile::append(const Json& line) {
  if (!begun_) begin();
  write(line);
}

void JournalFile::append_machine(const std::string& machine) {
  if (machines_.insert(machine).second) append({{"machine", machine}});
}

std::set<std::string> read_journal(const std::filesystem::path& folder,
                                   const JournalHead& head,
                                   const std::string& option,
                                   const TakeLine& take) {
  const std::filesystem::path path = folder / head.file;
  const auto refuse = [&](const std::string& reason) {
    throw UserError(option + " = " + folder.string() + ": " + reason);
  };
  try {
    const FileDescriptor file = open_regular(path, O_RDONLY);
    if (!file.is_open()) refuse("has no " + head.file);
    return LineReader(head, take).read(read_file(file, path)).machines;
  } catch (const Fault& fault) {
    refuse("its " + head.file + " " + fault.reason);
    return {};
  }
}

}  // namespace wobblebench::bench
