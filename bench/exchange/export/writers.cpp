#include "bench/exchange/export/writers.h"

#include <algorithm>
#include <stdexcept>

#include "base/user_error.h"

namespace wobblebench::bench {

namespace {

struct Format {
  std::string ending;
  ExportFormat format;
  std::vector<Content> contents;  ///< that it can hold; the first is the usual one
};

/// Longer endings first.
const std::vector<Format>& formats() {
  static const std::vector<Format> all = {
      {".seq.nrrd", ExportFormat::nrrd_sequence, {Content::cartesian, Content::polar}},
      {".nrrd",
       ExportFormat::nrrd,
       {Content::cartesian, Content::polar, Content::labels, Content::parts}},
      {".mha",
       ExportFormat::meta_image,
       {Content::planes, Content::polar, Content::cartesian, Content::labels, Content::parts}},
      {".npz", ExportFormat::npz, {Content::everything, Content::polar, Content::slices}},
      {".dcm", ExportFormat::dicom, {Content::cartesian}},
      {".hdf5", ExportFormat::zea, {Content::polar}},
      {".vol", ExportFormat::kretz, {Content::polar}},
      {".ply", ExportFormat::ply, {Content::found, Content::truth}}};
  return all;
}

std::string name_of(Content content) {
  std::string found;
  struct Names {
    Content wanted;
    std::string& found;
    void choice(std::string_view,
                const Content& value,
                std::initializer_list<std::pair<std::string_view, Content>> names) {
      for (const auto& [name, candidate] : names) {
        if (candidate == value) found = name;
      }
    }
    void choice(std::string_view,
                const SampleType&,
                std::initializer_list<std::pair<std::string_view, SampleType>>) {}
    void real(std::string_view, const double&, double, double, double) {}
  } names{content, found};
  const FileOptions options{.content = content};
  describe(options, names);
  return found;
}

const Format& format_of(const std::string& name) {
  for (const Format& format : formats()) {
    if (name.ends_with(format.ending) && name.size() > format.ending.size()) return format;
  }
  throw UserError("--to = " + name +
                  ": must end with .npz, .nrrd, .seq.nrrd, .mha, .hdf5, .vol, .dcm or .ply");
}

bool has_samples(Content content) {
  return content == Content::polar || content == Content::cartesian || content == Content::planes;
}

}  // namespace

ExportFormat export_format(const std::string& name) {
  return format_of(name).format;
}

bool has_labels(Content content) {
  return content == Content::labels || content == Content::parts;
}

bool has_spacing(Content content) {
  return content == Content::cartesian || content == Content::planes || has_labels(content);
}

bool needs_picture(Content content) {
  return content == Content::everything || content == Content::found || content == Content::truth ||
         content == Content::slices;
}

FileOptions chosen_options(const std::string& name,
                           const FileOptions& options,
                           const std::vector<std::string>& given,
                           std::uint32_t volumes,
                           bool is_known) {
  const Format& format = format_of(name);
  const auto refuse = [&](const std::string& why) {
    throw UserError("--to = " + name + ": " + why);
  };
  FileOptions chosen = options;
  if (chosen.content == Content::usual) chosen.content = format.contents.front();
  const std::string content = name_of(chosen.content);
  if (std::ranges::find(format.contents, chosen.content) == format.contents.end()) {
    std::string allowed;
    for (const Content one : format.contents)
      allowed += (allowed.empty() ? "" : ", ") + name_of(one);
    refuse("content = " + content + ": must be one of " + allowed);
  }
  const auto was_given = [&](const char* key) { return std::ranges::count(given, key) > 0; };
  if (was_given("spacing_mm") && !has_spacing(chosen.content)) {
    refuse("spacing_mm: acts with content=cartesian, planes, labels or parts; content is " +
           content);
  }
  const bool takes_type = has_samples(chosen.content) && format.format != ExportFormat::npz &&
                          format.format != ExportFormat::kretz &&
                          format.format != ExportFormat::zea &&
                          format.format != ExportFormat::dicom;
  if (was_given("type") && !takes_type) {
    refuse("type: acts with samples in .nrrd and .mha; the type of this file is fixed");
  }
  if (chosen.type == SampleType::usual) chosen.type = SampleType::u8;
  if ((has_labels(chosen.content) || chosen.content == Content::truth) && !is_known) {
    refuse("content = " + content + ": needs samples of a known phantom");
  }
  const bool takes_one =
      format.format == ExportFormat::nrrd || format.format == ExportFormat::kretz ||
      format.format == ExportFormat::dicom || has_labels(chosen.content) ||
      (format.format == ExportFormat::meta_image && chosen.content == Content::cartesian);
  if (takes_one && volumes > 1) {
    refuse("holds one volume; --volumes is " + std::to_string(volumes) +
           (has_samples(chosen.content) ? ": a .seq.nrrd file holds several" : ""));
  }
  return chosen;
}

void check_motor(const std::string& what, const hw::AcquisitionPlan& plan) {
  if (plan.acquisition().motor == hw::MotorMode::stepped) return;
  throw UserError(what +
                  ": holds one motor angle a frame, and the motor turns during a frame (only "
                  "acquisition.motor = stepped does not); a Cartesian volume or .npz is right");
}

void check_motor(const std::string& name,
                 const FileOptions& options,
                 const hw::AcquisitionPlan& plan) {
  const ExportFormat format = export_format(name);
  const bool by_frame = options.content == Content::polar || options.content == Content::planes;
  const bool by_stick = format == ExportFormat::npz || format == ExportFormat::zea;
  if (!by_frame || by_stick) return;
  check_motor("--to = " + name + ": content = " + name_of(options.content), plan);
}

std::unique_ptr<ScanWriter> make_writer(ExportFormat format,
                                        const std::filesystem::path& path,
                                        const FileOptions& options,
                                        const ExportedScan& scan) {
  switch (format) {
    case ExportFormat::npz:
      if (options.content == Content::slices) return make_slices_writer(path, scan);
      return make_npz_writer(path, options, scan);
    case ExportFormat::nrrd:
    case ExportFormat::nrrd_sequence:
    case ExportFormat::meta_image:
    case ExportFormat::dicom:
      return make_grid_writer(format, path, options, scan);
    case ExportFormat::zea:
      return make_zea_writer(path, options, scan);
    case ExportFormat::kretz:
      return make_kretz_writer(path, options, scan);
    case ExportFormat::ply:
      return make_ply_writer(path, options, scan);
  }
  throw std::logic_error("a format without a writer");
}

}  // namespace wobblebench::bench
