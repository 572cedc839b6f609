// A board of any --board argument, as Python iterates over it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/pipeline/acquire.h"
#include "bench/pipeline/stream/frame_reader.h"
#include "bench/python/scan.h"
#include "bench/python/scene.h"

namespace wobblebench::python {

/// Opens the board at once, and reads it from the first next_frame() on.
class BoardReader {
 public:
  /// `scene`: whose truth and settings go with the samples; null: the samples alone are read.
  /// Throws as commands do.
  BoardReader(const std::string& text, ScenePointer scene);

  /// None: the stream is over. Throws what ended it.
  std::optional<bench::StreamFrame> next_frame() { return frames_->next(); }
  /// The rest of a volume whose first frames next_frame() returned is left out.
  VolumePointer next_volume();
  /// Ends next_frame() in another thread, and the stream.
  void stop() { frames_->stop(); }

  /// With the board's probe, acquisition and display scale; null as it was given.
  const ScenePointer& scene() const { return scene_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  const hw::AcquisitionPlan& plan() const { return plan_.value(); }
  std::optional<hw::BoardAccount> account() const { return frames_->account(); }

 private:
  hw::SubjectHash subject();
  void resolve(const ScenePointer& given);
  void open_without_scene();

  bench::BoardArguments arguments_;
  std::optional<bench::BoardConnection> connection_;
  std::unique_ptr<hw::Board> board_;  ///< without a scene
  std::optional<hw::AcquisitionPlan> plan_;
  ScenePointer scene_;
  std::optional<hw::SubjectHash> subject_;  ///< of the samples, once it is known
  std::vector<std::string> warnings_;
  bool knows_times_ = true;                   ///< known from the first frame on
  std::optional<bench::FrameSource> frames_;  ///< last: it uses the others
};

}  // namespace wobblebench::python
