// The figures of "error" in report.json: a picture against the truth, of the surface that the probe
// can see unless something else is said.
#pragma once

#include "bench/results/measure.h"

namespace wobblebench::bench::error {

inline constexpr Measure kBias{
    "bias_mm", "bias", "Mean depth error, found less true", Worse::away_from_zero};
inline constexpr Measure kRms{"rms_mm", "RMS", "Root mean square of the depth error"};
inline constexpr Measure kMedian{
    "median_mm", "median", "Median depth error, found less true", Worse::away_from_zero};
inline constexpr Measure kP95{"p95_mm", "P95", "95 % quantile of the depth error's magnitude"};
inline constexpr Measure kMax{"max_mm", "greatest", "Greatest magnitude of the depth error"};
inline constexpr Measure kOutliers{
    "outliers_percent", "beyond 10 mm", "Of the pixels: depth error above 10 mm"};
inline constexpr Measure kPixels{
    "pixels", "pixels", "With a true and a found surface", Worse::neither};
inline constexpr Measure kPicturePixels{
    "picture_pixels", "pixels of the picture", "All pixels of the picture", Worse::neither};

inline constexpr Measure kOutsideRms{
    "outside_rms_mm", "RMS outside silhouettes", "RMS outside the band at silhouettes"};
inline constexpr Measure kOutsideP95{
    "outside_p95_mm", "P95 outside silhouettes", "P95 outside the band at silhouettes"};

inline constexpr Measure kSurface{
    "surface_percent", "surface", "Of the picture: a true surface", Worse::neither};
inline constexpr Measure kSurfaceArea{
    "surface_cm2", "surface", "Area of the true surface", Worse::neither};
inline constexpr Measure kMissed{
    "missed_percent", "missed", "Of the picture: a true surface, and none is found"};
inline constexpr Measure kMissedSurface{
    "missed_surface_percent", "missed of the surface", "Of the true surface's area: not found"};
inline constexpr Measure kFalse{
    "false_percent", "false", "Of the picture: a surface is found, and there is none"};
inline constexpr Measure kFalseSurface{"false_surface_percent",
                                       "false of what is found",
                                       "Of the found surface's area: there is none"};
inline constexpr Measure kMissedOrFalse{
    "missed_or_false_percent", "missed or false", "Sum of the two"};
inline constexpr Measure kFoundArea{
    "found_surface_cm2", "found surface", "Area of the found surface", Worse::neither};

inline constexpr Measure kOutsideField{"outside_field_percent",
                                       "outside the field",
                                       "Of the picture: a surface outside the probe's field",
                                       Worse::neither};
inline constexpr Measure kShadowed{
    "shadowed_percent", "shadowed", "Of the picture: a surface in a shadow", Worse::neither};
inline constexpr Measure kCutByBox{"cut_by_box_percent",
                                   "cut by the box",
                                   "Of the area that the probe could see: outside "
                                   "render.volume_of_interest, in picture and truth"};
inline constexpr Measure kGrazing{
    "grazing_percent", "grazing", "Of the picture: a surface that sticks graze", Worse::neither};
inline constexpr Measure kGrazingMissed{"grazing_missed_percent",
                                        "of grazing missed",
                                        "Of the pixels that sticks graze: nothing is found"};
inline constexpr Measure kGrazingP95{
    "grazing_p95_mm", "P95 where grazing", "P95 of the pixels that sticks graze"};

inline constexpr Measure kDrawn{
    "drawn_percent", "drawn beyond", "Of the picture: the surface was not found, but continued"};
inline constexpr Measure kDrawnFalse{
    "drawn_false_percent", "false, drawn beyond", "Of the picture: continued where there is none"};
inline constexpr Measure kDrawnP95{
    "drawn_p95_mm", "P95, drawn beyond", "P95 of the pixels that were not found, but continued"};

inline constexpr Measure kMouthP95{"mouth_p95_mm", "mouth, P95", "P95 of the mouth with its lips"};
inline constexpr Measure kMouthMissed{
    "mouth_missed_percent", "mouth, missed", "Of the mouth's pixels: nothing is found"};
inline constexpr Measure kNoseP95{"nose_p95_mm", "nose, P95", "P95 of the nose"};
inline constexpr Measure kNoseMissed{
    "nose_missed_percent", "nose, missed", "Of the nose's pixels: nothing is found"};
inline constexpr Measure kEyesP95{"eyes_p95_mm", "eyes, P95", "P95 of the eyelids"};
inline constexpr Measure kEyesMissed{
    "eyes_missed_percent", "eyes, missed", "Of the eyelids' pixels: nothing is found"};
inline constexpr Measure kEarsP95{"ears_p95_mm", "ears, P95", "P95 of the ears"};
inline constexpr Measure kEarsMissed{
    "ears_missed_percent", "ears, missed", "Of the ears' pixels: nothing is found"};

inline constexpr Measure kNormalMean{
    "normal_mean_deg", "normals, mean", "Mean angle to the true normal, as shaded"};
inline constexpr Measure kNormalMedian{
    "normal_median_deg", "normals, median", "Median angle to the true normal, as shaded"};
inline constexpr Measure kNormalP95{
    "normal_p95_deg", "normals, P95", "95 % quantile of the angle to the true normal, as shaded"};
inline constexpr Measure kNormalPixels{
    "normal_pixels", "normals", "Pixels with both normals", Worse::neither};
inline constexpr Measure kRawNormalMean{
    "raw_normal_mean_deg", "raw normals, mean", "Mean angle to the true normal, before pass 3"};
inline constexpr Measure kRawNormalMedian{"raw_normal_median_deg",
                                          "raw normals, median",
                                          "Median angle to the true normal, before pass 3"};
inline constexpr Measure kRawNormalP95{
    "raw_normal_p95_deg", "raw normals, P95", "95 % quantile of that angle, before pass 3"};
inline constexpr Measure kRawNormalPixels{
    "raw_normal_pixels", "raw normals", "Pixels with both normals", Worse::neither};

inline constexpr Measure kDistanceMean{
    "distance_mean_mm", "distance, mean", "Mean distance in space between the surfaces"};
inline constexpr Measure kDistanceP95{
    "distance_p95_mm", "distance, P95", "95 % quantile of the distance in space"};
inline constexpr Measure kDistanceMax{
    "distance_max_mm", "distance, greatest", "Greatest distance in space, in either direction"};
inline constexpr Measure kDistancePixels{
    "distance_pixels", "distances", "Points with a distance, both directions", Worse::neither};
inline constexpr Measure kHausdorff95{
    "hausdorff95_mm", "Hausdorff 95", "The greater P95 of the two directions"};

inline constexpr Measure kSsim{
    "ssim", "SSIM", "Similarity to the truth shaded alike", Worse::lower};
inline constexpr Measure kPsnr{
    "psnr_db", "PSNR", "Of the picture to the truth shaded alike", Worse::lower};

}  // namespace wobblebench::bench::error
