// A client on the classes of libOpenIGTLink: prints a line for each message whose CRC is right.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "igtlClientSocket.h"
#include "igtlImageMessage.h"
#include "igtlMessageHeader.h"
#include "igtlPolyDataMessage.h"
#include "igtlStatusMessage.h"
#include "igtlTransformMessage.h"

namespace {

/// The body of a message behind its header.
template <class Message>
typename Message::Pointer received(igtl::ClientSocket* socket, igtl::MessageHeader* header) {
  auto message = Message::New();
  message->SetMessageHeader(header);
  message->AllocatePack();
  socket->Receive(message->GetPackBodyPointer(), message->GetPackBodySize());
  if ((message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY) == 0) std::exit(3);
  return message;
}

void print_head(igtl::MessageBase* message, const char* type) {
  auto time = igtl::TimeStamp::New();
  message->GetTimeStamp(time);
  std::printf("%s %s %.9f", type, message->GetDeviceName(), time->GetTimeStamp());
}

void print_image(igtl::ImageMessage* image) {
  print_head(image, "IMAGE");
  int size[3];
  float spacing[3];
  igtl::Matrix4x4 matrix;
  image->GetDimensions(size);
  image->GetSpacing(spacing);
  image->GetMatrix(matrix);
  const auto* bytes = static_cast<const unsigned char*>(image->GetScalarPointer());
  long sum = 0;
  for (int i = 0; i < image->GetImageSize(); ++i) sum += bytes[i];
  std::printf(" %d %d %d %g %g %g", size[0], size[1], size[2], spacing[0], spacing[1], spacing[2]);
  std::printf(" %.6f %.6f %.6f %ld\n", matrix[0][3], matrix[1][3], matrix[2][3], sum);
}

void print_surface(igtl::PolyDataMessage* surface) {
  print_head(surface, "POLYDATA");
  igtl::PolyDataPointArray::Pointer points = surface->GetPoints();
  igtl::PolyDataCellArray::Pointer cells = surface->GetPolygons();
  const int count = points->GetNumberOfPoints();
  double sum[3] = {0, 0, 0};
  for (int i = 0; i < count; ++i) {
    igtlFloat32 point[3];
    points->GetPoint(i, point);
    for (int k = 0; k < 3; ++k) sum[k] += point[k];
  }
  std::printf(" %d %d", count, static_cast<int>(cells->GetNumberOfCells()));
  std::printf(" %.6f %.6f %.6f\n", sum[0] / count, sum[1] / count, sum[2] / count);
}

void print_transform(igtl::TransformMessage* transform) {
  print_head(transform, "TRANSFORM");
  igtl::Matrix4x4 matrix;
  transform->GetMatrix(matrix);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) std::printf(" %.7f", matrix[row][column]);
  }
  std::printf("\n");
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return 2;
  auto socket = igtl::ClientSocket::New();
  if (socket->ConnectToServer("127.0.0.1", std::atoi(arguments[1])) != 0) return 1;
  auto header = igtl::MessageHeader::New();
  for (;;) {
    header->InitPack();
    if (socket->Receive(header->GetPackPointer(), header->GetPackSize()) != header->GetPackSize()) {
      return 0;
    }
    header->Unpack();
    const std::string type = header->GetDeviceType();
    if (type == "IMAGE") print_image(received<igtl::ImageMessage>(socket, header));
    if (type == "POLYDATA") print_surface(received<igtl::PolyDataMessage>(socket, header));
    if (type == "TRANSFORM") print_transform(received<igtl::TransformMessage>(socket, header));
    if (type == "STATUS") {
      auto status = received<igtl::StatusMessage>(socket, header);
      print_head(status, "STATUS");
      std::printf(" %d\n", status->GetCode());
    }
  }
}
