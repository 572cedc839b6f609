// The library that bench/exchange/files/dicom_volume.cpp loads. Modules and functional groups are
// those of the Enhanced US Volume (PS3.3, A.59); dciodvfy checks them.
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "bench/exchange/files/dicom_volume.h"

namespace wobblebench::bench {

namespace {

/// Nobody was born, and nothing acquired, at a date of its own.
constexpr const char* kDate = "20000101";
constexpr const char* kTime = "000000";
constexpr const char* kDateTime = "20000101000000";
constexpr const char* kImageType = "ORIGINAL\\PRIMARY\\VOLUME\\NONE";

/// A DICOM item that is filled.
class Item {
 public:
  explicit Item(DcmItem& item) : item_(item) {}

  Item& text(const DcmTagKey& tag, const std::string& value) {
    check(item_.putAndInsertString(tag, value.c_str()));
    return *this;
  }
  Item& number(const DcmTagKey& tag, double value) {
    check(item_.putAndInsertFloat64(tag, value));
    return *this;
  }
  Item& numbers(const DcmTagKey& tag, const std::vector<double>& values) {
    check(item_.putAndInsertFloat64Array(tag, values.data(), values.size()));
    return *this;
  }
  Item& decimal(const DcmTagKey& tag, double value) {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%.10g", value);
    return text(tag, digits);
  }
  Item& whole(const DcmTagKey& tag, std::uint16_t value) {
    check(item_.putAndInsertUint16(tag, value));
    return *this;
  }
  Item& long_whole(const DcmTagKey& tag, std::uint32_t value) {
    check(item_.putAndInsertUint32(tag, value));
    return *this;
  }
  /// An attribute that names another.
  Item& tag(const DcmTagKey& name, const DcmTagKey& other) {
    check(item_.putAndInsertTagKey(name, other));
    return *this;
  }
  /// The sequence's item of this number, made if it is not there.
  Item sequence(const DcmTagKey& tag, long number = 0) {
    DcmItem* found = nullptr;
    check(item_.findOrCreateSequenceItem(tag, found, number));
    return Item(*found);
  }
  Item& empty_sequence(const DcmTagKey& tag) {
    check(item_.insertEmptyElement(tag));
    return *this;
  }
  Item& code(const DcmTagKey& tag, const char* value, const char* scheme, const char* meaning) {
    sequence(tag)
        .text(DCM_CodeValue, value)
        .text(DCM_CodingSchemeDesignator, scheme)
        .text(DCM_CodeMeaning, meaning);
    return *this;
  }

 private:
  static void check(const OFCondition& result) {
    if (result.bad()) throw std::runtime_error(result.text());
  }
  DcmItem& item_;
};

std::string uid(const DicomVolume& volume, int number) {
  return volume.uid_root + std::to_string(number);
}

void add_patient_and_study(Item& item, const DicomVolume& volume) {
  item.text(DCM_SpecificCharacterSet, "ISO_IR 192")
      .text(DCM_SOPClassUID, UID_EnhancedUSVolumeStorage)
      .text(DCM_SOPInstanceUID, uid(volume, 1))
      .text(DCM_PatientName, volume.patient)
      .text(DCM_PatientID, volume.patient)
      .text(DCM_PatientBirthDate, "")
      .text(DCM_PatientSex, "O")
      .text(DCM_PatientOrientation, "")
      .text(DCM_StudyInstanceUID, uid(volume, 2))
      .text(DCM_StudyDate, kDate)
      .text(DCM_StudyTime, kTime)
      .text(DCM_StudyID, "1")
      .text(DCM_AccessionNumber, "")
      .text(DCM_ReferringPhysicianName, "")
      .text(DCM_Modality, "US")
      .text(DCM_SeriesInstanceUID, uid(volume, 3))
      .text(DCM_SeriesNumber, "1")
      .text(DCM_SeriesDescription, volume.description)
      .text(DCM_Manufacturer, "wobblebench")
      .text(DCM_ManufacturerModelName, "wobblebench")
      .text(DCM_DeviceSerialNumber, "0")
      .text(DCM_SoftwareVersions, volume.version);
}

/// The Volume Frame of Reference is the probe frame. The transducer's has its origin in the middle
/// of the face, x along the array, y into the body, and z = x × y: (x, z - face, -y).
void add_frames_of_reference(Item& item, const DicomVolume& volume) {
  item.text(DCM_FrameOfReferenceUID, uid(volume, 4))
      .text(DCM_PositionReferenceIndicator, "")
      .text(DCM_SynchronizationFrameOfReferenceUID, uid(volume, 5))
      .text(DCM_SynchronizationTrigger, "NO TRIGGER")
      .text(DCM_AcquisitionTimeSynchronized, "N")
      .text(DCM_VolumeFrameOfReferenceUID, uid(volume, 6))
      .text(DCM_UltrasoundAcquisitionGeometry, "APEX")
      .numbers(DCM_ApexPosition, {0, 0, 0})
      .numbers(DCM_VolumeToTransducerMappingMatrix,
               {1, 0, 0, 0, 0, 0, 1, -volume.face_mm, 0, -1, 0, 0, 0, 0, 0, 1});
}

void add_acquisition(Item& item, const DicomVolume& volume) {
  item.text(DCM_ImageType, kImageType)
      .text(DCM_InstanceNumber, "1")
      .text(DCM_ContentDate, kDate)
      .text(DCM_ContentTime, kTime)
      .text(DCM_AcquisitionDateTime, kDateTime)
      .number(DCM_AcquisitionDuration, volume.duration_ms)
      .text(DCM_PositionMeasuringDeviceUsed, "RIGID")
      .text(DCM_LossyImageCompression, "00")
      .text(DCM_PresentationLUTShape, "IDENTITY")
      .text(DCM_RescaleIntercept, "0")
      .text(DCM_RescaleSlope, "1")
      .text(DCM_BurnedInAnnotation, "NO")
      .empty_sequence(DCM_AcquisitionContextSequence)
      .number(DCM_DepthsOfFocus, volume.focus_mm)
      .decimal(DCM_DepthOfScanField, std::round(volume.depth_mm));
  // No sound was sent.
  for (const auto& tag : {DCM_MechanicalIndex,
                          DCM_BoneThermalIndex,
                          DCM_CranialThermalIndex,
                          DCM_SoftTissueThermalIndex}) {
    item.decimal(tag, 0);
  }
  item.code(DCM_ViewCodeSequence, "111301", "DCM", "view")
      .code(DCM_AnatomicRegionSequence, "113345001", "SCT", "Abdomen")
      .code(DCM_TransducerScanPatternCodeSequence, "125242", "DCM", "Volume scan pattern")
      .code(DCM_TransducerGeometryCodeSequence,
            "125253",
            "DCM",
            "Curved linear ultrasound transducer geometry")
      .code(DCM_TransducerBeamSteeringCodeSequence, "125258", "DCM", "Mechanical beam steering")
      .code(DCM_TransducerApplicationCodeSequence, "125261", "DCM", "External Transducer");
  item.sequence(DCM_ViewCodeSequence).empty_sequence(DCM_ViewModifierCodeSequence);
}

void add_dimensions(Item& item, const DicomVolume& volume) {
  item.text(DCM_DimensionOrganizationType, "3D");
  item.sequence(DCM_DimensionOrganizationSequence)
      .text(DCM_DimensionOrganizationUID, uid(volume, 7));
  Item index = item.sequence(DCM_DimensionIndexSequence);
  index.text(DCM_DimensionOrganizationUID, uid(volume, 7))
      .text(DCM_DimensionDescriptionLabel, "Image Position (Volume)");
  index.tag(DCM_DimensionIndexPointer, DCM_ImagePositionVolume)
      .tag(DCM_FunctionalGroupPointer, DCM_PlanePositionVolumeSequence);
}

void add_shared_groups(Item& item, const DicomVolume& volume) {
  Item shared = item.sequence(DCM_SharedFunctionalGroupsSequence);
  char spacing[40];
  std::snprintf(spacing, sizeof spacing, "%.10g\\%.10g", volume.spacing_mm, volume.spacing_mm);
  shared.sequence(DCM_PixelMeasuresSequence)
      .text(DCM_PixelSpacing, spacing)
      .decimal(DCM_SliceThickness, volume.spacing_mm)
      .decimal(DCM_SpacingBetweenSlices, volume.spacing_mm);
  shared.sequence(DCM_FrameVOILUTSequence)
      .text(DCM_WindowCenter, "128")
      .text(DCM_WindowWidth, "256");
  shared.sequence(DCM_PlaneOrientationVolumeSequence)
      .numbers(DCM_ImageOrientationVolume, {1, 0, 0, 0, 1, 0});
  shared.sequence(DCM_ImageDataTypeSequence)
      .text(DCM_DataType, "TISSUE_INTENSITY")
      .text(DCM_AliasedDataType, "NO");
  shared.sequence(DCM_USImageDescriptionSequence)
      .text(DCM_FrameType, kImageType)
      .text(DCM_VolumetricProperties, "VOLUME")
      .text(DCM_VolumeBasedCalculationTechnique, "NONE");
}

void add_frame_groups(Item& item, const DicomVolume& volume) {
  for (std::uint32_t plane = 0; plane < volume.planes; ++plane) {
    Item frame = item.sequence(DCM_PerFrameFunctionalGroupsSequence, static_cast<long>(plane));
    Item content = frame.sequence(DCM_FrameContentSequence);
    content.whole(DCM_FrameAcquisitionNumber, 1)
        .text(DCM_FrameReferenceDateTime, kDateTime)
        .text(DCM_FrameAcquisitionDateTime, kDateTime)
        .number(DCM_FrameAcquisitionDuration, volume.duration_ms)
        .long_whole(DCM_DimensionIndexValues, plane + 1);
    frame.sequence(DCM_PlanePositionVolumeSequence)
        .numbers(DCM_ImagePositionVolume,
                 {volume.origin_mm.x,
                  volume.origin_mm.y,
                  volume.origin_mm.z + plane * volume.spacing_mm});
  }
}

void write(const std::filesystem::path& path, const DicomVolume& volume) {
  DcmFileFormat file;
  DcmDataset& dataset = *file.getDataset();
  Item item(dataset);
  add_patient_and_study(item, volume);
  add_frames_of_reference(item, volume);
  add_acquisition(item, volume);
  add_dimensions(item, volume);
  add_shared_groups(item, volume);
  add_frame_groups(item, volume);
  item.text(DCM_NumberOfFrames, std::to_string(volume.planes))
      .whole(DCM_Rows, volume.rows)
      .whole(DCM_Columns, volume.columns)
      .whole(DCM_SamplesPerPixel, 1)
      .text(DCM_PhotometricInterpretation, "MONOCHROME2")
      .whole(DCM_BitsAllocated, 8)
      .whole(DCM_BitsStored, 8)
      .whole(DCM_HighBit, 7)
      .whole(DCM_PixelRepresentation, 0);
  OFCondition result = dataset.putAndInsertUint8Array(
      DCM_PixelData, volume.voxels.data(), static_cast<unsigned long>(volume.voxels.size()));
  if (result.good()) result = file.saveFile(path.c_str(), EXS_LittleEndianExplicit);
  if (result.bad()) throw std::runtime_error(result.text());
}

}  // namespace

}  // namespace wobblebench::bench

extern "C" void wobblebench_write_dicom(const std::filesystem::path& path,
                                        const wobblebench::bench::DicomVolume& volume) {
  try {
    wobblebench::bench::write(path, volume);
  } catch (const std::exception& error) {
    throw std::runtime_error(path.string() + ": cannot be written: " + error.what());
  }
}
