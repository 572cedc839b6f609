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
  frames_.emplace([this] {
    const bench::ResolvedScene& resolved = scene_->resolved();
    const std::lock_guard maps_used(scene_->subject()->mutex);
    auto source = connection_->connect(resolved, scene_->subject()->maps);
    knows_times_ = source.knows_times();
    return source;
  });
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
  subject_ = first.configuration.subject;
  knows_times_ = first.configuration.knows_times;
  // A recording that ends within its first volume can be read once more.
  if (board_->state() == hw::BoardState::lost) {
    board_ = std::make_unique<hw::Board>(bench::open_board_link(arguments_, {}));
  }
  frames_.emplace([this, first] {
    return bench::StreamSource{.board = *board_,
                               .plan = *plan_,
                               .name = arguments_.text,
                               .configuration = first.configuration,
                               .before_configuration = first.before};
  });
}

/// Of all volumes: it may take a reading of the phantom's files.
hw::SubjectHash BoardReader::subject() {
  if (!subject_) {
    const bench::ResolvedScene& scene = scene_->resolved();
    subject_ = scene.subject() ? bench::subject_hash(scene.options()) : hw::SubjectHash{};
  }
  return *subject_;
}

VolumePointer BoardReader::next_volume() {
  VolumePointer volume;
  const bool is_there = frames_->next_volume([&](const bench::StreamFrame& frame) {
    if (!volume || volume->index != frame.volume) {
      volume = std::make_shared<VolumeData>(plan(), frame.volume);
      volume->subject = subject();
      volume->knows_times = knows_times_;
    }
    volume->set_frame(frame.frame, frame.samples);
  });
  return is_there ? volume : nullptr;
}

}  // namespace wobblebench::python
