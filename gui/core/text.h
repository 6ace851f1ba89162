#pragma once

#include <QPixmap>
#include <QString>
#include <array>
#include <opencv2/core.hpp>
#include <string>

#include "mapping/base/time_zone.h"
#include "memory/identity/states.h"

namespace loci::gui {

/// "2026-05-01 09:10:00" in the memory's zone, with fractions where there are any.
QString time_text(TimeNs time, const TimeZone& zone);
/// "Europe/Berlin, UTC+02:00" at a time.
QString zone_text(TimeNs time, const TimeZone& zone);
/// "just now", "3 min", "2 h 5 min", "28 h", "4 days": how long `to` is after `from`.
QString duration_text(TimeNs from, TimeNs to);
/// How far a scene is from a time: "2 h 10 min before", "3 min later"; empty where it stands for that time.
QString apart_text(TimeNs scene, TimeNs time);

QString percent_text(double probability);
/// A state, kind of event or explanation in words: "out of view".
template <memory::StateEnum State>
QString state_text(State state) {
  return QString(memory::to_text(state)).replace('_', ' ');
}

/// A small filled square.
QPixmap swatch(const std::array<uint8_t, 3>& rgb, int side);
/// In the middle of a transparent square: names beside images of any shape stand in line.
QPixmap centred(const QPixmap& image, int side);
/// CV_8UC3 BGR as an image; null when empty.
QImage image_of(const cv::Mat& bgr);

/// What the states of objects mean, for tooltips.
inline constexpr const char* kStatusHelp =
    "seen: in the scene of the selected time\n"
    "out of view: believed to be where it was\n"
    "hidden: behind something\n"
    "missed: its place was seen without it, but it may still be there\n"
    "gone: believed to have left";

}  // namespace loci::gui
