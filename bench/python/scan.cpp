#include "bench/python/scan.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "base/units.h"
#include "base/user_error.h"
#include "bench/evaluation/head_pose/find_head.h"
#include "bench/python/arrays.h"
#include "bench/python/board.h"
#include "bench/python/calls.h"
#include "bench/results/counts.h"
#include "hw/recording/recording.h"

namespace wobblebench::python {

namespace {

using BoardPointer = std::shared_ptr<BoardReader>;

std::size_t of(int count) {
  return static_cast<std::size_t>(count);
}

/// Values of a function of 0, 1, … count - 1.
template <class Function>
py::array_t<double> tabulated(int count, const Function& function) {
  py::array_t<double> values(count);
  auto value = values.mutable_unchecked<1>();
  for (int i = 0; i < count; ++i) value(i) = function(i);
  return values;
}

py::array_t<double> stick_times_s(const VolumeData& volume) {
  const auto& scan = volume.plan.acquisition();
  py::array_t<double> times({scan.frames_per_volume, scan.sticks_per_frame});
  auto time = times.mutable_unchecked<2>();
  for (int frame = 0; frame < scan.frames_per_volume; ++frame) {
    for (int line = 0; line < scan.sticks_per_frame; ++line) {
      const auto stick = volume.plan.sequence(
          {volume.index, static_cast<std::uint32_t>(frame), static_cast<std::uint32_t>(line)});
      time(frame, line) = volume.knows_times
                              ? to_seconds(volume.plan.stick_time(stick) - hw::DeviceTime{})
                              : std::nan("");
    }
  }
  return times;
}

/// A frame with the Python object that owns it.
struct FrameData {
  bench::StreamFrame frame;
  hw::AcquisitionPlan plan;
};

void add_frame(py::module_& module) {
  py::class_<FrameData, std::shared_ptr<FrameData>>(
      module, "Frame", "One image plane of a volume, as it came from a board.")
      .def_property_readonly(
          "samples",
          [](const py::object& self) {
            const auto& data = self.cast<const FrameData&>();
            const auto& scan = data.plan.acquisition();
            return shown(data.frame.samples.samples.data(),
                         {scan.sticks_per_frame, scan.samples_per_stick},
                         self);
          },
          "float32 [line, sample], log-compressed in [0, 1]. A view.")
      .def_property_readonly(
          "arrived",
          [](const py::object& self) {
            const auto& arrived = self.cast<const FrameData&>().frame.samples.arrived;
            return shown_flags(arrived, {static_cast<py::ssize_t>(arrived.size())}, self);
          },
          "bool [line]: False where the stick was lost, and its samples are 0. A view.")
      .def_property_readonly(
          "volume", [](const FrameData& self) { return self.frame.volume; }, "Index, from 0.")
      .def_property_readonly(
          "index",
          [](const FrameData& self) { return self.frame.frame; },
          "Of the plane in the fan, from 0.")
      .def_property_readonly(
          "ends_volume",
          [](const FrameData& self) { return self.frame.ends_volume; },
          "No other frame of this volume follows.");
}

void add_volume(py::module_& module) {
  py::class_<VolumeData, VolumePointer>(
      module,
      "Volume",
      "The samples of one sweep of the probe, in its polar coordinates (docs/units.md).")
      .def_property_readonly(
          "samples",
          [](const py::object& self) {
            const auto& volume = self.cast<const VolumeData&>();
            const auto& scan = volume.plan.acquisition();
            return shown(volume.samples.data(),
                         {scan.frames_per_volume, scan.sticks_per_frame, scan.samples_per_stick},
                         self,
                         Access::write);
          },
          "float32 [frame, line, sample], log-compressed in [0, 1]. A view: what is written to it "
          "is rendered.")
      .def_property_readonly(
          "arrived",
          [](const py::object& self) {
            const auto& volume = self.cast<const VolumeData&>();
            const auto& scan = volume.plan.acquisition();
            return shown_flags(
                volume.arrived, {scan.frames_per_volume, scan.sticks_per_frame}, self);
          },
          "bool [frame, line]: False where the stick was lost, and its samples are 0. A view.")
      .def_property_readonly(
          "motor_angles_rad",
          [](const py::object& self) {
            const auto& volume = self.cast<const VolumeData&>();
            const auto& scan = volume.plan.acquisition();
            return shown(volume.motor_angle_rad.data(),
                         {scan.frames_per_volume, scan.sticks_per_frame},
                         self);
          },
          "[frame, line]: the motor's angle at each stick. A view.")
      .def_property_readonly(
          "ranges_m",
          [](const VolumeData& self) {
            return tabulated(self.plan.acquisition().samples_per_stick,
                             [&](int sample) { return self.plan.sample_range_m(sample); });
          },
          "[sample]: distance from the probe's face along the stick.")
      .def_property_readonly(
          "line_angles_rad",
          [](const VolumeData& self) {
            return tabulated(self.plan.acquisition().sticks_per_frame,
                             [&](int line) { return self.plan.theta_rad(line); });
          },
          "[line]: of the stick in the image plane.")
      .def_property_readonly(
          "frame_angles_rad",
          [](const VolumeData& self) {
            return tabulated(self.plan.acquisition().frames_per_volume,
                             [&](int frame) { return self.plan.frame_phi_rad(frame); });
          },
          "[frame]: motor angle of the frame, by the plan.")
      .def_property_readonly(
          "times_s",
          stick_times_s,
          "[frame, line]: when each stick is fired, by the plan; nan where that is not known.")
      .def_property_readonly(
          "radius_m",
          [](const VolumeData& self) { return self.plan.probe().radius_m; },
          "Radius of curvature of the probe's face.")
      .def_property_readonly(
          "wobble_radius_m",
          [](const VolumeData& self) { return self.plan.probe().wobble_radius_m; },
          "Distance of the wobble axis behind the face.")
      .def_readonly("index", &VolumeData::index, "In the stream, from 0.");
}

void add_board(py::module_& module) {
  // Ctrl-C ends the stream: what the thread took would be missing from it.
  const auto next = [](const BoardPointer& board) {
    auto volume = released([board] { return board->next_volume(); }, [board] { board->stop(); });
    if (!volume) throw py::stop_iteration();
    return volume;
  };
  const auto next_frame = [](const BoardPointer& board) {
    auto frame = released([board] { return board->next_frame(); }, [board] { board->stop(); });
    if (!frame) throw py::stop_iteration();
    return std::make_shared<FrameData>(FrameData{std::move(*frame), board->plan()});
  };
  struct Frames {
    BoardPointer board;
  };
  using FramesPointer = std::shared_ptr<Frames>;
  py::class_<Frames, FramesPointer>(module, "FrameIterator", "The frames of a board.")
      .def("__iter__", [](const FramesPointer& self) { return self; })
      .def("__next__", [next_frame](const Frames& self) { return next_frame(self.board); });
  py::class_<BoardReader, BoardPointer>(
      module,
      "Board",
      "Iterates over the volumes of a board: the simulator, a recording, a card. It waits for its "
      "caller: only a card loses sticks to one that is slow, and counts them. Ctrl-C ends it.")
      .def(py::init([](const std::string& board, const ScenePointer& scene) {
             auto made = released([=] { return std::make_shared<BoardReader>(board, scene); });
             issue_warnings(made->warnings());
             return made;
           }),
           py::arg("board") = "sim",
           py::arg("scene") = nullptr,
           "`board`: as --board takes it (docs/board.md). `scene`: what the simulator scans, or "
           "what "
           "a recording is compared with; without one the samples alone are read. Raises BadInput.")
      .def("__iter__", [](const BoardPointer& self) { return self; })
      .def("__next__", next, "The next volume.")
      .def(
          "frames",
          [](const BoardPointer& board) { return std::make_shared<Frames>(Frames{board}); },
          "Iterates over frames as they come.")
      .def("stop", &BoardReader::stop, "Ends the stream.")
      .def_property_readonly(
          "scene",
          [](const BoardReader& board) -> std::optional<ScenePointer> {
            if (!board.scene()) return std::nullopt;
            return board.scene();
          },
          "The scene with the board's probe, acquisition and display scale; None without one.")
      .def_property_readonly(
          "account",
          [](const BoardReader& board) -> std::optional<py::dict> {
            const auto account = board.account();
            if (!account) return std::nullopt;
            return from_json(bench::to_json(bench::described(*account)).dump());
          },
          "Sticks emitted, delivered and lost so far, by causes; None before the first volume.");
  module.def(
      "simulate",
      [](const ScenePointer& scene) {
        auto volume = released([scene] {
          bench::BoardConnection(bench::parse_board("sim")).check_one_volume(scene->given());
          return BoardReader("sim", scene).next_volume();
        });
        issue_warnings(scene->take_warnings());
        return volume;
      },
      py::arg("scene"),
      "The volume that the simulated probe makes of a scene of one volume. Raises BadInput.");
  module.def(
      "find_head",
      [](const VolumePointer& volume) {
        return released([volume] {
          return bench::find_head_view(volume->plan, volume->polar().frames(), "find_head");
        });
      },
      py::arg("volume"),
      "The settings that show the fetal head in a volume upright and whole, for Scene.replace(), "
      "as "
      "`run --frame` finds them. Raises BadInput where there is none.");
}

/// A recording that was read once.
struct RecordingData {
  explicit RecordingData(std::string file) : path(std::move(file)) {
    try {
      contents = hw::inspect_recording(path);
    } catch (const hw::LinkOpenError& error) {
      throw UserError(error.what());
    }
  }
  std::string path;
  hw::RecordingContents contents;
};

void add_recording(py::module_& module) {
  py::class_<RecordingData, std::shared_ptr<RecordingData>>(
      module,
      "Recording",
      "What a recording holds, and what is wrong with it; iterates over volumes.")
      .def(py::init([](const std::string& path) {
             return released([path] { return std::make_shared<RecordingData>(path); });
           }),
           py::arg("path"),
           "Reads the whole file, as `wobblebench inspect`. Raises BadInput.")
      .def(
          "board",
          [](const RecordingData& self, const ScenePointer& scene) {
            const std::string board = "file=" + self.path;
            return released([=] { return std::make_shared<BoardReader>(board, scene); });
          },
          py::arg("scene") = nullptr,
          "A Board that reads it.")
      .def("__iter__",
           [](const RecordingData& self) {
             const std::string board = "file=" + self.path;
             return released([=] { return std::make_shared<BoardReader>(board, nullptr); });
           })
      .def_readonly("path", &RecordingData::path)
      .def_property_readonly("bytes", [](const RecordingData& self) { return self.contents.bytes; })
      .def_property_readonly(
          "sticks",
          [](const RecordingData& self) { return self.contents.sticks; },
          "That are intact and in order.")
      .def_property_readonly(
          "lost",
          [](const RecordingData& self) { return self.contents.account.lost.total(); },
          "Sticks that were emitted and are not here.")
      .def_property_readonly(
          "volumes",
          [](const RecordingData& self) { return self.contents.volumes.size(); },
          "Of which a stick is there.")
      .def_property_readonly(
          "acquisitions",
          [](const RecordingData& self) { return self.contents.acquisition_count; },
          "One after the other, each with settings of its own.")
      .def_property_readonly(
          "complete",
          [](const RecordingData& self) { return self.contents.complete(); },
          "No stick is missing, and every volume that began is closed.")
      .def_property_readonly(
          "damaged",
          [](const RecordingData& self) { return self.contents.damaged(); },
          "Bytes were lost or changed, or cannot be read.");
}

}  // namespace

VolumeData::VolumeData(const hw::AcquisitionPlan& of_plan, std::uint32_t number)
    : plan(of_plan), index(number) {
  const auto sticks = of(plan.sticks_per_volume());
  samples.resize(sticks * of(plan.acquisition().samples_per_stick));
  arrived.resize(sticks);
  motor_angle_rad.resize(sticks);
}

void VolumeData::set_frame(int frame, const hw::PolarFrame& from) {
  const auto at = [&](std::size_t size) { return static_cast<std::ptrdiff_t>(of(frame) * size); };
  std::ranges::copy(from.samples, samples.begin() + at(from.samples.size()));
  std::ranges::copy(from.arrived, arrived.begin() + at(from.arrived.size()));
  std::ranges::copy(from.motor_angle_rad, motor_angle_rad.begin() + at(from.arrived.size()));
}

hw::PolarFrame VolumeData::frame(int frame) const {
  const auto lines = of(plan.acquisition().sticks_per_frame);
  const auto part = [&](const auto& all, std::size_t size) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(of(frame) * size);
    return std::vector(begin, begin + static_cast<std::ptrdiff_t>(size));
  };
  return {part(samples, lines * of(plan.acquisition().samples_per_stick)),
          part(arrived, lines),
          part(motor_angle_rad, lines)};
}

hw::PolarVolume VolumeData::polar() const {
  hw::PolarVolume volume(plan, index);
  for (int i = 0; i < plan.acquisition().frames_per_volume; ++i) {
    volume.place_frame(i, frame(i), hw::SampleScale::log_compressed);
  }
  return volume;
}

void add_scan(py::module_& module) {
  add_frame(module);
  add_volume(module);
  add_board(module);
  add_recording(module);
}

}  // namespace wobblebench::python
