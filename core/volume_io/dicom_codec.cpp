// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/dicom_codec.h"

#include <array>
#include <exception>
#include <istream>
#include <streambuf>

#include <gdcmImageReader.h>
#include <gdcmReader.h>
#include <gdcmTrace.h>

namespace {
// A stream over an open file, beginning at the file's first byte.
class FileBuffer final : public std::streambuf {
 public:
  explicit FileBuffer(const LimberDicomFile& file) : file_(file) {}

 protected:
  int_type underflow() override {
    const std::size_t got = file_.read_at(file_.context, end_, buffer_.data(), buffer_.size());
    if (got == 0) return traits_type::eof();
    end_ += static_cast<off_type>(got);
    setg(buffer_.data(), buffer_.data(), buffer_.data() + got);
    return traits_type::to_int_type(buffer_[0]);
  }
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const off_type now = end_ - (egptr() - gptr());
    const off_type place = offset + (from == std::ios_base::cur ? now : from == std::ios_base::end ? file_.size : 0);
    if (place < 0 || place > file_.size) return pos_type(off_type(-1));
    if (place != now) {
      setg(nullptr, nullptr, nullptr);
      end_ = place;
    }
    return pos_type(place);
  }
  pos_type seekpos(pos_type place, std::ios_base::openmode mode) override {
    return seekoff(place, std::ios_base::beg, mode);
  }

 private:
  const LimberDicomFile& file_;
  off_type end_ = 0;  // file offset of the end of the buffered bytes
  std::array<char, 1 << 16> buffer_;
};

void be_silent() {
  gdcm::Trace::DebugOff();
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
}
}  // namespace

int limber_dicom_elements(const LimberDicomFile* opened, LimberDicomElement visit, void* context) try {
  be_silent();
  FileBuffer buffer(*opened);
  std::istream file(&buffer);
  gdcm::Reader reader;
  reader.SetStream(file);
  const gdcm::Tag pixels(0x7fe0, 0x0010);
  if (!reader.ReadUpToTag(pixels)) return 1;
  for (const gdcm::DataElement& element : reader.GetFile().GetDataSet().GetDES())
    if (const gdcm::ByteValue* value = element.GetByteValue(); value && value->GetPointer())
      visit(context, element.GetTag().GetGroup(), element.GetTag().GetElement(), value->GetPointer(),
            value->GetLength());
  return 0;
} catch (const std::exception&) {
  return 1;
}

int limber_dicom_pixels(const LimberDicomFile* opened, char* pixels, std::size_t size) try {
  be_silent();
  FileBuffer buffer(*opened);
  std::istream file(&buffer);
  gdcm::ImageReader reader;
  reader.SetStream(file);
  if (!reader.Read()) return 1;
  const gdcm::Image& image = reader.GetImage();
  return image.GetNumberOfDimensions() == 2 && image.GetBufferLength() == size && image.GetBuffer(pixels) ? 0 : 1;
} catch (const std::exception&) {
  return 1;
}
