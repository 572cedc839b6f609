// --send ARGS: where a stream is sent while it runs, and what of it.
#pragma once

#include <cstdint>
#include <string>

#include "base/options.h"
#include "base/units.h"
#include "bench/exchange/igtl/sockets.h"

namespace wobblebench::bench {

/// Axes of positions in messages. IMAGE names them; TRANSFORM and POLYDATA do not, and 3D Slicer
/// takes all for RAS.
enum class SendAxes { ras, lps };
enum class SendType { u8, u16 };

struct SendOptions {
  std::string content = "picture+volume+surface+pose";  ///< of these and polar
  double spacing_m = 2e-3;                              ///< of the grid of `volume`
  SendType type = SendType::u8;                         ///< of the samples of volume and polar
  SendAxes axes = SendAxes::ras;
  int header = 2;   ///< version of message headers; 1: without metadata
  int clients = 8;  ///< at once
  int wait = 0;     ///< clients that must be connected before the stream begins
};

template <OptionsOf<SendOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.text("content", o.content);
  v.real("spacing_mm", o.spacing_m, kMillimetre, 0.1, 20);
  v.choice("type", o.type, {{"uint8", SendType::u8}, {"uint16", SendType::u16}});
  v.choice("axes", o.axes, {{"ras", SendAxes::ras}, {"lps", SendAxes::lps}});
  v.integer("header", o.header, 1, 2);
  v.integer("clients", o.clients, 1, 64);
  v.integer("wait", o.wait, 0, 64);
}

struct SendArguments {
  std::string text;  ///< as given
  Endpoint endpoint;
  SendOptions options;
  bool picture = false, volume = false, polar = false, surface = false, pose = false;
};

/// Throws UserError "--send = ARGS: key = value: what is allowed".
SendArguments parse_send(const std::string& text);

}  // namespace wobblebench::bench
