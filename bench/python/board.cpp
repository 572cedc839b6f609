#include "bench/python/board.h"

#include <utility>

#include "bench/python/calls.h"
#include "bench/scene/subject_hash.h"

namespace wobblebench::python {

BoardReader::BoardReader(const std::string& text, ScenePointer scene)
    : arguments_(bench::parse_board(text)) {
  if (scene == nullptr && bench::is_simulated(arguments_)) {
    scene = std::make_shared<SceneHandle>("", std::vector<std::string>{});
  }
  if (scene == nullptr) {
    open_without_scene();
    return;
  }
  connection_.emplace(arguments_);
  resolve(scene);
  plan_ = scene_->resolved().plan();
}

BoardReader::~BoardReader() {
  stop();
  if (thread_.joinable()) thread_.join();
}

void BoardReader::resolve(const ScenePointer& given) {
  if (bench::is_simulated(arguments_)) {
    scene_ = given;
    static_cast<void>(scene_->resolved());
    warnings_ = scene_->take_warnings();
    return;
  }
  const auto progress = silent_progress();
  auto subject = std::make_shared<Subject>();
  auto resolved = connection_->resolve(given->given(), subject->cache, *progress);
  scene_ = std::make_shared<SceneHandle>(*given, std::move(resolved), std::move(subject));
  warnings_ = progress->warnings();
}

void BoardReader::open_without_scene() {
  board_ = std::make_unique<hw::Board>(bench::open_board_link(arguments_, {}));
  const auto first = bench::first_configuration(*board_, arguments_.text);
  plan_ = first.configuration.plan;
  // A recording that ends within its first volume can be read once more.
  if (board_->state() == hw::BoardState::lost) {
    board_ = std::make_unique<hw::Board>(bench::open_board_link(arguments_, {}));
  }
  source_.emplace(bench::StreamSource{.board = *board_,
                                      .plan = *plan_,
                                      .name = arguments_.text,
                                      .configuration = first.configuration,
                                      .before_configuration = first.before});
}

void BoardReader::start() {
  if (queue_) return;
  if (scene_) {
    const bench::ResolvedScene& scene = scene_->resolved();
    const std::lock_guard maps_used(scene_->subject()->mutex);
    auto source = connection_->connect(scene, scene_->subject()->maps);
    const std::lock_guard lock(starting_);
    source_.emplace(std::move(source));
  }
  const std::lock_guard lock(starting_);
  queue_ = std::make_unique<bench::VolumeQueue>(
      bench::QueueOptions{.policy = bench::StreamPolicy::every});
  if (stopped_) queue_->stop();
  source_->board.start();
  thread_ = std::thread([this] { read(); });
}

void BoardReader::read() {
  try {
    bench::FrameReader(*source_, *queue_, /*volumes=*/0, /*keep_volume=*/false).run();
  } catch (...) {
    failure_ = std::current_exception();
    queue_->close();
  }
}

std::optional<bench::StreamFrame> BoardReader::next_frame() {
  const std::lock_guard lock(reading_);
  return read_frame();
}

std::optional<bench::StreamFrame> BoardReader::read_frame() {
  start();
  auto frame = queue_->pop();
  if (frame) return frame;
  if (thread_.joinable()) thread_.join();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::nullopt;
}

/// Of all volumes: it may take a reading of the phantom's files.
hw::SubjectHash BoardReader::subject() {
  if (!scene_) return source_->configuration.value().subject;
  const bench::ResolvedScene& scene = scene_->resolved();
  if (!subject_) {
    subject_ = scene.subject() ? bench::subject_hash(scene.options()) : hw::SubjectHash{};
  }
  return *subject_;
}

VolumePointer BoardReader::next_volume() {
  const std::lock_guard lock(reading_);  // over all of it: frames go to one caller
  VolumePointer volume;
  while (auto frame = read_frame()) {
    if (!volume || volume->index != frame->volume) {
      volume = std::make_shared<VolumeData>(plan(), frame->volume);
      volume->subject = subject();
    }
    volume->set_frame(frame->frame, frame->samples);
    if (frame->ends_volume) return volume;
  }
  return nullptr;
}

void BoardReader::stop() {
  const std::lock_guard lock(starting_);
  stopped_ = true;
  if (queue_) queue_->stop();
  if (source_) source_->board.cancel();
}

std::optional<hw::BoardAccount> BoardReader::account() const {
  const std::lock_guard lock(starting_);
  if (!source_) return std::nullopt;
  return source_->board.account();
}

}  // namespace wobblebench::python
