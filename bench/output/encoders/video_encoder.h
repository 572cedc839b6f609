// Encoding of videos by OpenCV's VideoWriter.
#pragma once

#include <filesystem>
#include <memory>

#include "bench/output/encoders.h"

namespace wobblebench::bench {

/// As Encoders::open_video.
std::unique_ptr<VideoEncoder> open_video(const std::filesystem::path& path,
                                         const VideoFormat& format);

}  // namespace wobblebench::bench
