#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>

#include "cleave/core/overloaded.hpp"
#include "cleave/core/text.hpp"
#include "cleave/io/joint_csv.hpp"

namespace cleave::io {

std::string write_joint_csv(const JointTable& table) {
  const auto any = [&](auto&& holds) { return std::ranges::any_of(table.rows, holds); };
  const bool position = any([](const JointRow& r) { return r.position.has_value(); });
  const bool disc = any([](const JointRow& r) { return std::holds_alternative<DiscSize>(r.size); });
  const bool rectangle = any([](const JointRow& r) { return std::holds_alternative<RectangleSize>(r.size); });
  const bool friction = any([](const JointRow& r) { return r.friction.has_value(); });
  const bool cohesion = any([](const JointRow& r) { return r.cohesion.has_value(); });
  const bool tension = any([](const JointRow& r) { return r.tension.has_value(); });
  const bool set = any([](const JointRow& r) { return !r.set.empty(); });
  const bool id = any([](const JointRow& r) { return !r.id.empty(); });
  std::string out = "dip,dip_direction";
  if (position) out += ",x,y,z";
  if (disc) out += ",radius";
  if (rectangle) out += ",side_a,side_b,rotation";
  if (friction) out += ",friction";
  if (cohesion) out += ",cohesion";
  if (tension) out += ",tension";
  if (set) out += ",set";
  if (id) out += ",id";
  out += '\n';
  auto to = std::back_inserter(out);
  for (const JointRow& r : table.rows) {
    fmt::format_to(to, "{},{}", r.plane.dip.degrees(), r.plane.direction.degrees());
    if (position) {
      if (r.position)
        fmt::format_to(to, ",{},{},{}", r.position->x, r.position->y, r.position->z);
      else
        out += ",,,";
    }
    std::visit(overloaded{
                   [&](Persistent) { out += std::string(std::size_t{disc} + 3 * std::size_t{rectangle}, ','); },
                   [&](DiscSize d) { fmt::format_to(to, ",{}{}", d.radius.si(), rectangle ? ",,," : ""); },
                   [&](const RectangleSize& s) {
                     fmt::format_to(to, "{},{},{},{}", disc ? "," : "", s.side_a.si(), s.side_b.si(),
                                    s.rotation.degrees());
                   },
               },
               r.size);
    if (friction) out += r.friction ? fmt::format(",{}", r.friction->degrees()) : ",";
    if (cohesion) out += r.cohesion ? fmt::format(",{}", r.cohesion->si()) : ",";
    if (tension) out += r.tension ? fmt::format(",{}", r.tension->si()) : ",";
    if (set) out += ',' + csv_field(r.set, ";#");
    if (id) out += ',' + csv_field(r.id, ";#");
    out += '\n';
  }
  return out;
}

}  // namespace cleave::io
