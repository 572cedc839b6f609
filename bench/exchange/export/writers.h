// The writers of each format.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "bench/exchange/export/exported_scan.h"

namespace wobblebench::bench {

enum class ExportFormat { npz, nrrd, nrrd_sequence, meta_image, ply, kretz, zea, dicom };

/// Of a file's name. Throws UserError "--to = NAME: …" with all that can be written.
ExportFormat export_format(const std::string& name);

/// The options with what `usual` stands for in this format. Throws UserError "--to = NAME: KEY =
/// VALUE: …" for what the format does not hold, or what does not act beside it. `is_known`: the
/// scanned subject is.
FileOptions chosen_options(const std::string& name,
                           const FileOptions& options,
                           const std::vector<std::string>& given,
                           std::uint32_t volumes,
                           bool is_known);

/// Whether the file holds labels, a byte each.
bool has_labels(Content content);

/// Whether the file's points have equal spacing.
bool has_spacing(Content content);

/// Throws UserError for a grid of absurd size.
void check_grid(const std::string& name,
                const FileOptions& options,
                const hw::AcquisitionPlan& plan);

/// Throws UserError for samples by frames, each of one motor angle, where the motor turns during a
/// frame. `what`: is refused.
void check_motor(const std::string& what, const hw::AcquisitionPlan& plan);
void check_motor(const std::string& name,
                 const FileOptions& options,
                 const hw::AcquisitionPlan& plan);

/// Whether the file holds something of the rendered picture.
bool needs_picture(Content content);

/// `path`: of the new file; `options`: of chosen_options(). `scan` must outlive the writer. Throws
/// std::runtime_error as OutFile does.
std::unique_ptr<ScanWriter> make_writer(ExportFormat format,
                                        const std::filesystem::path& path,
                                        const FileOptions& options,
                                        const ExportedScan& scan);

/// Each for one kind of file.
std::unique_ptr<ScanWriter> make_npz_writer(const std::filesystem::path& path,
                                            const FileOptions& options,
                                            const ExportedScan& scan);
/// Of pass 1's slices.
std::unique_ptr<ScanWriter> make_slices_writer(const std::filesystem::path& path,
                                               const ExportedScan& scan);
std::unique_ptr<ScanWriter> make_grid_writer(ExportFormat format,
                                             const std::filesystem::path& path,
                                             const FileOptions& options,
                                             const ExportedScan& scan);
std::unique_ptr<ScanWriter> make_kretz_writer(const std::filesystem::path& path,
                                              const FileOptions& options,
                                              const ExportedScan& scan);
std::unique_ptr<ScanWriter> make_zea_writer(const std::filesystem::path& path,
                                            const FileOptions& options,
                                            const ExportedScan& scan);
std::unique_ptr<ScanWriter> make_ply_writer(const std::filesystem::path& path,
                                            const FileOptions& options,
                                            const ExportedScan& scan);

}  // namespace wobblebench::bench
