// A board of any --board argument, as Python iterates over it.
#pragma once

#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bench/pipeline/acquire.h"
#include "bench/pipeline/stream/frame_reader.h"
#include "bench/python/scan.h"
#include "bench/python/scene.h"

namespace wobblebench::python {

/// Opens the board at once, reads it from the first next_frame() on, on a thread of its own, and
/// waits for its caller: frames are dropped by a card alone, and counted.
class BoardReader {
 public:
  /// `scene`: whose truth and settings go with the samples; null: the samples alone are read.
  /// Throws as commands do.
  BoardReader(const std::string& text, ScenePointer scene);
  ~BoardReader();
  BoardReader(const BoardReader&) = delete;
  BoardReader& operator=(const BoardReader&) = delete;

  /// None: the stream is over. Throws what ended it.
  std::optional<bench::StreamFrame> next_frame();
  /// The rest of a volume whose first frames next_frame() returned is left out.
  VolumePointer next_volume();
  /// Ends next_frame() in another thread, and the stream.
  void stop();

  /// With the board's probe, acquisition and display scale; null as it was given.
  const ScenePointer& scene() const { return scene_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  const hw::AcquisitionPlan& plan() const { return plan_.value(); }
  std::optional<hw::BoardAccount> account() const;

 private:
  hw::SubjectHash subject();
  void resolve(const ScenePointer& given);
  void open_without_scene();
  void start();
  void read();
  std::optional<bench::StreamFrame> read_frame();  ///< with reading_

  bench::BoardArguments arguments_;
  std::optional<bench::BoardConnection> connection_;
  std::unique_ptr<hw::Board> board_;  ///< without a scene
  std::optional<hw::AcquisitionPlan> plan_;
  ScenePointer scene_;
  std::optional<hw::SubjectHash> subject_;  ///< of scene_, once it is known
  std::vector<std::string> warnings_;

  std::mutex reading_;  ///< of those that call next_…()
  std::optional<bench::StreamSource> source_;
  std::unique_ptr<bench::VolumeQueue> queue_;
  std::exception_ptr failure_;  ///< of the thread, once the queue is closed
  std::thread thread_;
  mutable std::mutex starting_;  ///< of source_ and queue_
  bool stopped_ = false;
};

}  // namespace wobblebench::python
