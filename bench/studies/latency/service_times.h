// How long the stages of a stream take: the modelled card, by its schedule, and the host, as
// observed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/pipeline/stream/stream.h"
#include "bench/pipeline/stream/stream_summary.h"
#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// Times of one stick on the device's clock, seconds after the volume's first stick was fired.
struct CardTimes {
  double dma_complete_s = 0;  ///< the last byte of its packet has come over the PCIe link
  double interrupt_s = 0;     ///< that announces this byte
};

/// Times of all sticks of a volume, in the order of acquisition, as sim::SimLink sends them through
/// a card (sim/card/card_model.h) whose buffers are read at each interrupt.
std::vector<CardTimes> card_times(const hw::AcquisitionPlan& plan, const sim::CardOptions& card);

/// Time at which the card's interrupt announces the last stick of each frame, in the order of
/// acquisition: seconds after the volume's first stick was fired (sim/card/card_model.h).
std::vector<double> frame_announcements_s(const hw::AcquisitionPlan& plan,
                                          const sim::CardOptions& card);

CardDelays card_delays(const hw::AcquisitionPlan& plan, const sim::CardOptions& card);

/// Observed times in the order in which they were observed, seconds; a model draws from them.
struct TimePool {
  std::vector<double> values;

  double mean() const;
  /// The value `behind` entries after the one at this share of the pool, 0 to 1; the first follows
  /// the last. 0 if there is none.
  double at(double share, std::uint64_t behind) const;
  TimePool scaled(double factor) const;
};

struct ServiceTimes {
  TimePool wake;        ///< from the card's interrupt until a frame's last stick is taken
  TimePool frame;       ///< upload and pass 1 of a frame that does not end a volume
  TimePool last_frame;  ///< of the one that does
  TimePool picture;     ///< passes 2 to 4
  TimePool written;     ///< by the sink

  /// Mean time of one volume with this number of frames: what limits the rate of volumes.
  double renderer_s(int frames) const;
};

/// Service times measured on real-time streams of one setting. `card`: options of their link.
ServiceTimes measured_times(const std::vector<StreamResult>& rounds,
                            const hw::AcquisitionPlan& plan,
                            const sim::CardOptions& card);

/// Of one machine, by two numbers of frames a volume.
struct KnownTimes {
  std::string name;  ///< of the machine
  ServiceTimes one;
  int frames_of_one = 0;
  ServiceTimes other;
  int frames_of_other = 0;

  /// Those of `one`, in their order, with means that depend on the number of frames linearly
  /// between the two and beyond: of pass 1 for all frames but the last, of pass 1 for the last, and
  /// of the picture.
  ServiceTimes at(int frames) const;
};

/// The paper's: Table I, 53.7 ms of 27 frames and 54.6 ms of 37, on its GPU (docs/references.md
/// [1]); neither sink nor wake-up is known, and both take no time.
KnownTimes paper_times();

/// From report.json of `tables`: a machine by each of the settings there, "paper" and "default",
/// named by its GL_RENDERER. Wake-up and sink are not known, and take no time. Throws UserError
/// "--times = FILE: …".
std::vector<KnownTimes> read_known_times(const std::filesystem::path& file);

}  // namespace wobblebench::bench
