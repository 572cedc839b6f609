// A renderer of another program, as a stream takes it.
#pragma once

#include "bench/exchange/program/program_renderer.h"
#include "bench/pipeline/stream/stream.h"

namespace wobblebench::bench {

/// Gathers the frames of a volume, which the program gets as a whole.
class ProgramStreamRenderer : public StreamRenderer {
 public:
  /// `program` must outlive it.
  ProgramStreamRenderer(ProgramRenderer& program,
                        const hw::AcquisitionPlan& plan,
                        const render::RenderOptions& options)
      : program_(program), volume_(plan), options_(options) {}

  double add_frame(int frame, const hw::PolarFrame& samples) override {
    volume_.place_frame(frame, samples, hw::SampleScale::log_compressed);
    return 0;
  }
  render::Picture render() override { return program_.render(volume_, options_); }

 private:
  ProgramRenderer& program_;
  hw::PolarVolume volume_;
  render::RenderOptions options_;
};

}  // namespace wobblebench::bench
