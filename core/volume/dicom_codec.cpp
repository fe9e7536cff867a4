// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/dicom_codec.h"

#include <exception>

#include <gdcmImageReader.h>
#include <gdcmReader.h>
#include <gdcmTrace.h>

namespace {
void be_silent() {
  gdcm::Trace::DebugOff();
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
}
}  // namespace

int limber_dicom_elements(const char* path, LimberDicomElement visit, void* context) try {
  be_silent();
  gdcm::Reader reader;
  reader.SetFileName(path);
  const gdcm::Tag pixels(0x7fe0, 0x0010);
  if (!reader.ReadUpToTag(pixels)) return 1;
  for (const gdcm::DataElement& element : reader.GetFile().GetDataSet().GetDES())
    if (const gdcm::ByteValue* value = element.GetByteValue(); value && value->GetPointer())
      visit(context, element.GetTag().GetGroup(), element.GetTag().GetElement(), value->GetPointer(), value->GetLength());
  return 0;
} catch (const std::exception&) {
  return 1;
}

int limber_dicom_pixels(const char* path, char* pixels, std::size_t size) try {
  be_silent();
  gdcm::ImageReader reader;
  reader.SetFileName(path);
  if (!reader.Read()) return 1;
  const gdcm::Image& image = reader.GetImage();
  return image.GetNumberOfDimensions() == 2 && image.GetBufferLength() == size && image.GetBuffer(pixels) ? 0 : 1;
} catch (const std::exception&) {
  return 1;
}
