// Images of OpenIGTLink put together to volumes of sticks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/file.h"
#include "bench/exchange/igtl/left_out.h"
#include "bench/exchange/input/foreign_scan.h"
#include "bench/exchange/input/igtl_link.h"
#include "bench/exchange/input/igtl_receiver.h"

namespace wobblebench::bench {

/// Takes images that are volumes, or planes of a fan, all of one kind.
class IgtlVolumes {
 public:
  /// Of the first image, which is not added. Throws UserError "SERVER: …", and of the geometry.
  IgtlVolumes(const std::string& server,
              const ReceivedImage& first,
              const std::filesystem::path& geometry,
              const IgtlLinkOptions& options,
              std::shared_ptr<LeftOut> left_out);

  /// Adds an image; packets of the volumes that it ends. Throws ReceivingEnded for an image of
  /// another size or type.
  std::vector<std::byte> add(const ReceivedImage& received);
  /// Packets of what came of the last volume.
  std::vector<std::byte> finish() { return end_volume(); }

 private:
  /// Of an image, counted from the first one's volume.
  struct Place {
    std::uint32_t volume = 0;
    std::uint32_t frame = 0;
  };

  std::optional<Place> place_of(const ReceivedImage& received);
  std::optional<Place> next_in_order(std::uint64_t timestamp);
  bool lies_as_before(const IgtlImage& image) const;
  void store(const ReceivedImage& received, std::uint32_t frame);
  std::vector<std::byte> end_volume();

  std::string server_;
  IgtlLinkOptions options_;
  std::shared_ptr<LeftOut> left_out_;
  IgtlImage kind_;  ///< of each image; no voxels
  bool is_numbered_ = false;
  bool lies_in_space_ = false;  ///< positions are those of the images
  std::uint32_t frames_ = 1;    ///< images of a volume
  FileDescriptor voxels_;       ///< of the volume under way
  std::optional<ForeignScan> scan_;

  std::uint64_t first_volume_ = 0;  ///< number of the first one
  std::uint64_t images_ = 0;        ///< so far, of those without numbers, lost ones included
  std::uint64_t last_timestamp_ = 0;
  std::uint32_t volume_ = 0;  ///< under way
  std::vector<bool> there_;   ///< its frames
};

}  // namespace wobblebench::bench
