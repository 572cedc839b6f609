#include "bench/pipeline/iq_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "bench/exchange/files/npy.h"
#include "sim/optics/probe_optics.h"
#include "sim/optics/pulse_band.h"

namespace wobblebench::bench {

namespace {

constexpr std::uint64_t kSampleBytes = sizeof(std::complex<float>);

/// The header of an array of complex64.
std::string iq_header(std::span<const std::uint64_t> shape) {
  return npy_header(shape, "c8");
}

/// The same for any number of volumes: its padding takes up the digits.
std::uint64_t header_bytes(const hw::AcquisitionPlan& plan) {
  return iq_header(iq_shape(plan, 1)).size();
}

}  // namespace

IqShape iq_shape(const hw::AcquisitionPlan& plan, std::uint64_t volumes) {
  const hw::AcquisitionOptions& a = plan.acquisition();
  const int samples = a.samples_per_stick * sim::iq_oversampling(plan);
  return {volumes,
          static_cast<std::uint64_t>(a.frames_per_volume),
          static_cast<std::uint64_t>(a.sticks_per_frame),
          static_cast<std::uint64_t>(samples)};
}

IqFile::IqFile(std::filesystem::path path, const hw::AcquisitionPlan& plan)
    : path_(std::move(path)),
      file_(::open(path_.c_str(), O_CREAT | O_EXCL | O_NOFOLLOW | O_WRONLY | O_CLOEXEC, 0666)),
      plan_(plan) {
  if (!file_.is_open()) fail(errno);
}

void IqFile::fail(int error_number) {
  int none = 0;
  error_number_.compare_exchange_strong(none, error_number);
  throw std::runtime_error(path_.string() + ": cannot be written: " + std::strerror(error_number));
}

void IqFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count =
        ::pwrite(file_.get(), bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(errno);
    offset += static_cast<std::uint64_t>(count);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

void IqFile::write(const hw::StickIndex& index, std::span<const std::complex<float>> iq) {
  const std::shared_lock lock(writing_);
  if (finished_) return;
  const auto [unused, frames, lines, samples] = iq_shape(plan_, 1);
  if (iq.size() != samples) {
    throw std::logic_error("a stick of " + std::to_string(iq.size()) + " IQ samples: must be " +
                           std::to_string(samples));
  }
  const std::uint64_t stick = (index.volume * frames + index.frame) * lines + index.line;
  write_at(header_bytes(plan_) + stick * samples * kSampleBytes, std::as_bytes(iq));
}

void IqFile::finish(std::uint64_t volumes) {
  const std::unique_lock lock(writing_);
  finished_ = true;
  // A failure on the simulator's thread ended the recording as if the board were lost.
  if (error_number_ != 0) fail(error_number_);
  const IqShape shape = iq_shape(plan_, volumes);
  const std::string header = iq_header(shape);
  if (header.size() != header_bytes(plan_)) throw std::logic_error("NumPy header: its size varies");
  std::uint64_t bytes = kSampleBytes;
  for (const std::uint64_t size : shape) bytes *= size;
  if (::ftruncate(file_.get(), static_cast<off_t>(header.size() + bytes)) != 0) fail(errno);
  write_at(0, std::as_bytes(std::span(header)));
}

}  // namespace wobblebench::bench
