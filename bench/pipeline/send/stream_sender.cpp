#include "bench/pipeline/send/stream_sender.h"

#include <bit>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/number_text.h"
#include "base/user_error.h"
#include "bench/exchange/export/depth_mesh.h"
#include "bench/exchange/export/polar_sampler.h"
#include "bench/exchange/export/writers.h"
#include "bench/output/image_io.h"

namespace wobblebench::bench {

namespace {

// Names of devices: nodes of 3D Slicer get them.
constexpr const char* kPicture = "Picture";
constexpr const char* kVolume = "Volume";
constexpr const char* kPolar = "Polar";
constexpr const char* kSurface = "Surface";
constexpr const char* kPose = "MotorToProbe";
constexpr const char* kStatus = "Wobblebench";

constexpr double kMostVoxels = 6.4e7;
constexpr std::chrono::milliseconds kLastPatience{1000};

double seconds(hw::DeviceTime time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

/// Since a stick was fired, or where that is not known, since it came.
double age_ms(const StickTimes& stick) {
  return to_milliseconds(hw::HostClock::now() - stick.fired.value_or(stick.acquired));
}

template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::uint16_t small(int number) {
  return static_cast<std::uint16_t>(number);
}

IgtlServer make_server(const SendArguments& arguments) try {
  return {arguments.endpoint.host, arguments.endpoint.port, arguments.options.clients};
} catch (const std::runtime_error& error) {
  throw UserError("--send = " + arguments.text + ": cannot listen at " + error.what());
}

}  // namespace

StreamSender::StreamSender(const SendArguments& arguments)
    : arguments_(arguments), server_(make_server(arguments)) {}

StreamSender::~StreamSender() {
  const std::lock_guard lock(mutex_);
  ends_ = true;
  changed_.notify_all();
}

void StreamSender::begin(const ExportedScan& scan) {
  scan_ = &scan;
  if (arguments_.polar) check_motor("--send = " + arguments_.text + ": polar", scan.plan());
  if (arguments_.volume) {
    grid_ = grid_around(scan.plan(), arguments_.options.spacing_m);
    if (grid_->voxels() > kMostVoxels) {
      throw UserError("--send = " + arguments_.text + ": spacing_mm: the grid has " +
                      significant(grid_->voxels(), 4) + " voxels; must have at most " +
                      significant(kMostVoxels, 3));
    }
  }
  server_.greet(std::make_shared<const std::string>(
      igtl_status({.device = kStatus,
                   .metadata = scan.fields(),
                   .version = IgtlHeaderVersion{arguments_.options.header}},
                  "stream begins")));
  thread_ = std::jthread([this] { work(); });
  server_.wait_for_clients(arguments_.options.wait);
}

glm::dvec3 StreamSender::on_axes(const glm::dvec3& v) const {
  return arguments_.options.axes == SendAxes::lps ? v : glm::dvec3(-v.x, -v.y, v.z);
}

void StreamSender::send(const std::string& device, std::string message, int part) {
  server_.send(device + std::to_string(part),
               std::make_shared<const std::string>(std::move(message)));
  const std::lock_guard lock(mutex_);
  ++kinds_[device].made;
}

IgtlHead StreamSender::head(const char* device,
                            std::uint32_t volume,
                            const StickTimes& first,
                            const StickTimes& last,
                            int lost) const {
  const double newest_s = seconds(last.device);
  IgtlHead head{.device = device,
                .timestamp = scan_->knows_times ? igtl_timestamp(std::max(newest_s, 0.0)) : 0,
                .version = IgtlHeaderVersion{arguments_.options.header}};
  head.metadata = {{"wobblebench_source", scan_->simulated ? "simulated" : "recording of hardware"},
                   {"wobblebench_volume", std::to_string(volume)},
                   {"wobblebench_lost_sticks", std::to_string(lost)},
                   {"wobblebench_age_newest_ms", fixed(age_ms(last), 3)},
                   {"wobblebench_age_from", last.fired ? "scheduled emission" : "acquisition"}};
  if (!scan_->knows_times) return head;
  head.metadata.emplace_back("wobblebench_first_stick_s", fixed(seconds(first.device), 9));
  head.metadata.emplace_back("wobblebench_newest_stick_s", fixed(newest_s, 9));
  return head;
}

void StreamSender::add_frame(const StreamFrame& frame) {
  if (arguments_.pose && server_.has_clients()) send_pose(frame);
  if (arguments_.volume || arguments_.polar) collect(frame);
}

/// The rotation of the image plane about the motor's axis, from the plane at rest to the probe
/// frame.
void StreamSender::send_pose(const StreamFrame& frame) {
  const double phi_rad = mean_motor_angle_rad(frame.samples);
  const double sine = std::sin(phi_rad), cosine = std::cos(phi_rad);
  const double axis_mm = scan_->plan().geometry().axis_z_m() / kMillimetre;
  const double sign = arguments_.options.axes == SendAxes::lps ? 1 : -1;
  IgtlHead about = head(kPose,
                        frame.volume,
                        frame.first,
                        frame.last,
                        scan_->plan().acquisition().sticks_per_frame - frame.sticks);
  about.metadata.emplace_back("wobblebench_frame", std::to_string(frame.frame));
  about.metadata.emplace_back("wobblebench_motor_angle_deg", significant(phi_rad / kDegree, 12));
  send(kPose,
       igtl_transform(about,
                      {sign * on_axes({1, 0, 0}),
                       sign * on_axes({0, cosine, sine}),
                       on_axes({0, -sine, cosine})},
                      on_axes({0, axis_mm * sine, axis_mm * (1 - cosine)})),
       frame.frame);
}

/// Puts frames together to their volume.
void StreamSender::collect(const StreamFrame& frame) {
  if (!collected_ || collected_->volume.volume_index() != frame.volume) {
    collected_ = VolumeJob{
        .volume = hw::PolarVolume(scan_->plan(), frame.volume), .first = frame.first, .last = {}};
  }
  const hw::AcquisitionOptions& scan = scan_->plan().acquisition();
  collected_->volume.place_frame(frame.frame, frame.samples, hw::SampleScale::log_compressed);
  collected_->lost += scan.sticks_per_frame - frame.sticks;
  collected_->last = frame.last;
  ++collected_->frames;
  if (!frame.ends_volume || collected_->frames != scan.frames_per_volume) return;
  if (server_.has_clients())
    post(volume_, std::move(*collected_), arguments_.volume ? kVolume : kPolar);
  collected_.reset();
}

void StreamSender::take(const ShownPicture& shown) {
  if ((arguments_.picture || arguments_.surface) && server_.has_clients()) {
    post(picture_, shown, arguments_.picture ? kPicture : kSurface);
  }
}

template <class Job>
void StreamSender::post(std::optional<Job>& place, Job job, const char* device) {
  std::optional<Job> before(std::move(job));
  const std::lock_guard lock(mutex_);
  std::swap(place, before);
  if (before) ++kinds_[device].superseded;
  changed_.notify_all();
}

void StreamSender::work() {
  for (;;) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return ends_ || picture_ || volume_; });
    if (!picture_ && !volume_) return;
    const auto picture = std::exchange(picture_, std::nullopt);
    const auto volume = std::exchange(volume_, std::nullopt);
    lock.unlock();
    if (picture && arguments_.picture) send_picture(*picture);
    if (picture && arguments_.surface) send_surface(*picture);
    if (volume && arguments_.polar) send_polar(*volume);
    if (volume && arguments_.volume) send_volume(*volume);
  }
}

/// The picture in its place: of a parallel view on the view plane, of a perspective one in the
/// plane through the middle of the box.
void StreamSender::send_picture(const ShownPicture& shown) {
  const PictureTimes& times = shown.times;
  const render::Camera& camera = scan_->scene.view().camera;
  const Image<glm::vec3>& surface = shown.picture.surface;
  std::vector<std::uint8_t> pixels;
  pixels.reserve(3 * surface.pixels.size());
  for (const glm::vec3& light : surface.pixels) {
    // Rounded as OpenImageIO does, in floats, so that the picture is that of surface.png.
    for (int i = 0; i < 3; ++i) {
      pixels.push_back(static_cast<std::uint8_t>(std::floor(encoded(light[i]) * 255.0F + 0.5F)));
    }
  }
  const bool is_parallel = camera.projection == render::Projection::parallel;
  const double distance_m = is_parallel ? camera.plane_distance_m : 0;
  const double pixel_mm = camera.pixel_m() / kMillimetre;
  send(kPicture,
       igtl_image(head(kPicture, times.volume, times.first, times.last, times.lost),
                  {.sizes = {small(surface.width), small(surface.height), 1},
                   .components = 3,
                   .lps = arguments_.options.axes == SendAxes::lps,
                   .steps = {pixel_mm * on_axes(camera.right),
                             pixel_mm * on_axes(camera.down),
                             on_axes(camera.forward)},
                   .center = on_axes((camera.center - distance_m * camera.forward) / kMillimetre),
                   .voxels = bytes_of(pixels)}));
}

void StreamSender::send_surface(const ShownPicture& shown) {
  const PictureTimes& times = shown.times;
  const DepthMesh mesh(shown.picture.depth_m, scan_->scene.view().camera);
  std::vector<glm::vec3> points;
  points.reserve(mesh.pixels().size());
  for (const glm::ivec2& pixel : mesh.pixels()) {
    points.emplace_back(on_axes(mesh.point_m(pixel) / kMillimetre));
  }
  send(kSurface,
       igtl_surface(head(kSurface, times.volume, times.first, times.last, times.lost),
                    points,
                    mesh.corners()));
}

IgtlHead StreamSender::volume_head(const char* device,
                                   const char* content,
                                   const VolumeJob& job) const {
  IgtlHead about = head(device, job.volume.volume_index(), job.first, job.last, job.lost);
  const hw::AcquisitionOptions& scan = scan_->plan().acquisition();
  for (auto& field : scan_->fields()) {
    if (field.first != "wobblebench_source") about.metadata.push_back(std::move(field));
  }
  about.metadata.emplace_back("wobblebench_content", content);
  if (content != std::string("cartesian")) return about;
  about.metadata.emplace_back("wobblebench_lines", std::to_string(scan.sticks_per_frame));
  about.metadata.emplace_back("wobblebench_samples", std::to_string(scan.samples_per_stick));
  about.metadata.emplace_back("wobblebench_frames", std::to_string(scan.frames_per_volume));
  return about;
}

void StreamSender::send_samples(const IgtlHead& about,
                                IgtlImage image,
                                std::span<const float> samples) {
  image.lps = arguments_.options.axes == SendAxes::lps;
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint16_t> words;
  if (arguments_.options.type == SendType::u8) {
    bytes = whole_numbers<std::uint8_t>(samples);
    image.voxels = bytes_of(bytes);
  } else {
    words = whole_numbers<std::uint16_t>(samples);
    image.voxels = bytes_of(words);
    image.scalar = IgtlScalar::uint16;
    image.big_endian = std::endian::native == std::endian::big;
  }
  const std::string device = about.device;
  send(device, igtl_image(about, image));
}

void StreamSender::send_volume(const VolumeJob& job) {
  const SampleGrid& grid = grid_.value();
  const PolarSampler sampler(job.volume);
  std::vector<float> samples;
  samples.reserve(static_cast<std::size_t>(grid.voxels()));
  for (int z = 0; z < grid.size.z; ++z) {
    for (int y = 0; y < grid.size.y; ++y) {
      for (int x = 0; x < grid.size.x; ++x) {
        samples.push_back(static_cast<float>(sampler.at(grid.point_m(x, y, z)).value_or(0)));
      }
    }
  }
  const double step_mm = grid.spacing_m / kMillimetre;
  const glm::dvec3 last_m = grid.point_m(grid.size.x - 1, grid.size.y - 1, grid.size.z - 1);
  send_samples(volume_head(kVolume, "cartesian", job),
               {.sizes = {small(grid.size.x), small(grid.size.y), small(grid.size.z)},
                .steps = {step_mm * on_axes({1, 0, 0}),
                          step_mm * on_axes({0, 1, 0}),
                          step_mm * on_axes({0, 0, 1})},
                .center = on_axes(0.5 * (grid.low_m + last_m) / kMillimetre)},
               samples);
}

/// Samples by line and frame: no positions in space, which the metadata give.
void StreamSender::send_polar(const VolumeJob& job) {
  const hw::AcquisitionOptions& scan = scan_->plan().acquisition();
  std::vector<float> samples;
  for (const hw::PolarFrame& frame : job.volume.frames()) {
    samples.insert(samples.end(), frame.samples.begin(), frame.samples.end());
  }
  send_samples(volume_head(kPolar, "polar", job),
               {.sizes = {small(scan.samples_per_stick),
                          small(scan.sticks_per_frame),
                          small(scan.frames_per_volume)},
                .steps = {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)}},
               samples);
}

SendReport StreamSender::finish(const std::string& text) {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
    changed_.notify_all();
  }
  thread_.join();
  server_.send(kStatus,
               std::make_shared<const std::string>(
                   igtl_status({.device = kStatus,
                                .metadata = scan_->fields(),
                                .version = IgtlHeaderVersion{arguments_.options.header}},
                               text)));
  SendReport report{.address = server_.address(), .arguments = arguments_};
  report.server = server_.finish(kLastPatience);
  report.kinds = std::move(kinds_);
  return report;
}

}  // namespace wobblebench::bench
