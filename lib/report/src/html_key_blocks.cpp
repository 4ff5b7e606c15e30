#include "html_key_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "cleave/exchange/text.hpp"
#include "cleave/realize/places.hpp"
#include "drawings.hpp"
#include "tables.hpp"

namespace cleave::report {
namespace {

/// Smaller ones an engineer does not look for first.
constexpr Volume shown_from = Volume::from_si(1e-3);

void cell(std::string& out, double value, const std::string& shown) {
  out += "<td data-v=\"";
  append_number(out, value);
  out += "\">" + shown + "</td>";
}

std::string trend_and_plunge(const geometry::Vec3& d) {
  constexpr double to_degrees = 57.29577951308232;
  if (norm(d) == 0) return "–";
  double trend = std::atan2(d.x, d.y) * to_degrees;
  if (trend < 0) trend += 360;
  const double plunge = std::asin(std::clamp(-d.z, -1.0, 1.0)) * to_degrees;
  const auto whole = [](double v) { return std::to_string(std::lround(v)); };
  if (std::abs(plunge) > 89.95) return plunge > 0 ? "straight down" : "straight up";
  return whole(trend) + "° / " + (plunge < -0.5 ? "−" : "") + whole(std::abs(plunge)) + "°";
}

/// "roof (11:30), 12.4 m": where on the tunnel, and how far along it.
std::string where(const scene::BlockPlace& place) {
  std::string out{place.location};
  if (place.clock) out += " (" + clock_text(*place.clock) + ")";
  if (place.chainage) out += ", " + display(*place.chainage, 3) + " m";
  return out.empty() ? "–" : out;
}

/// Hidden in the table until they are asked for.
bool is_micro(const topology::Block& block) { return block.sliver || block.volume < shown_from; }

std::string key_block_rows(const Page& page, const std::vector<const stability::Judgement*>& judgements) {
  std::string out;
  for (const stability::Judgement* row : judgements) {
    const stability::Judgement& j = *row;
    const topology::Block& block = page.complex->blocks()[j.block];
    const std::vector<topology::JointId> joints = scene::joints_of(*page.complex, j.block);
    const scene::BlockPlace place = scene::place_of(page.result, *page.complex, j.block, joints);
    out += "<tr data-block=\"" + std::to_string(j.block.value()) + "\" class=\"" + (j.key ? "" : "stays ") +
           (is_micro(block) ? "micro" : "") + "\">";
    cell(out, j.block.value(), std::to_string(j.block.value()));
    const std::string swatch =
        j.batch ? "<i class=\"swatch\" style=\"background:" + batch_colour(*j.batch) + "\"></i>" : "";
    cell(out, j.batch ? *j.batch : 1e9,
         swatch + (j.batch ? std::to_string(*j.batch) : (j.key ? (j.transferred ? "held" : "later") : "stays")));
    out += "<td>";
    out += stability::name(j.mode);
    out += "</td><td>" + where(place) + "</td>";
    cell(out, block.volume.si(), display(block.volume.si()));
    cell(out, j.weight.si(), display(j.weight.si() / 1000));
    out += "<td>" + trend_and_plunge(j.direction) + "</td>";
    cell(out, j.net.si(), display(j.net.si() / 1000));
    cell(out, j.factor_of_safety, display(j.factor_of_safety, 3));
    if (page.result.analysis->force_transfer) {
      const double net = j.transferred ? j.transferred->net.si() : j.net.si();
      const double factor = j.transferred ? j.transferred->factor_of_safety : j.factor_of_safety;
      cell(out, net, display(net / 1000));
      cell(out, factor, display(factor, 3));
    }
    if (page.result.field_stress) {
      const auto& clamped = page.result.field_stress->blocks;
      const auto found = std::ranges::lower_bound(clamped, j.block, {}, &scene::ClampedBlock::block);
      if (found != clamped.end() && found->block == j.block) {
        cell(out, found->factor_of_safety, display(found->factor_of_safety, 3));
      } else {
        out += "<td>–</td>";
      }
    }
    if (page.result.analysis->rotation != stability::RotationCheck::off) {
      out += !j.rotation ? "<td>–</td>" : j.rotation->turns ? "<td class=\"warn\">turns</td>" : "<td>no</td>";
    }
    cell(out, place.free_area.si(), display(place.free_area.si(), 3));
    cell(out, place.depth.si(), display(place.depth.si(), 3));
    cell(out, place.extent.si(), display(place.extent.si(), 3));
    cell(out, static_cast<double>(block.faces.size()), std::to_string(block.faces.size()));
    std::string sets, numbers;
    for (const scene::SetId set : place.sets)
      sets += (sets.empty() ? "" : ", ") + escape_xml(page.result.sets[set].name);
    for (const topology::JointId joint : joints) {
      numbers += (numbers.empty() ? "" : ", ") + std::to_string(joint.value());
    }
    out += "<td>" + (sets.empty() ? "–" : sets) + "</td><td class=\"wide\">" + numbers + "</td></tr>\n";
  }
  return out;
}

}  // namespace

std::vector<const stability::Judgement*> by_severity(const stability::Analysis& analysis) {
  std::vector<const stability::Judgement*> out;
  for (const stability::Judgement& j : analysis.judgements) {
    if (stability::moves(j.mode) || j.key) out.push_back(&j);
  }
  std::ranges::stable_sort(out, {}, [](const stability::Judgement* j) {
    return std::pair{j->key ? 0 : 1, j->key ? -j->net.si() : j->factor_of_safety};
  });
  return out;
}

std::string key_blocks_section(const Page& page) {
  if (!page.result.analysis || page.complex == nullptr || !page.figures().key_blocks) return {};
  const scene::KeyBlockFigures& figures = *page.figures().key_blocks;
  std::string out = "<section id=\"keys\"><h2>Key blocks</h2>\n";
  if (figures.stopped_at_max_batches) {
    out += "<p class=\"note\">Stopped at the scene's largest number of batches: more blocks may follow.</p>\n";
  }
  if (!figures.batches.empty())
    out += "<figure class=\"half\">" + batch_bars(figures.batches) +
           "<figcaption>Volume that leaves, by batch. "
           "All blocks of a batch leave together; what they held up leaves in the next.</figcaption></figure>\n";
  const std::vector<const stability::Judgement*> judgements = by_severity(*page.result.analysis);
  if (judgements.empty()) return out + "<p>No removable block would move, even without friction.</p></section>\n";
  out +=
      "<p class=\"small\">Every removable block that would move without friction, the largest net force first; those "
      "that friction and cohesion hold are marked “stays” and follow by their factor. Click a heading to sort, a row "
      "to "
      "find the block in the view. Directions are trend / plunge, downwards positive. Depth: how far the block reaches "
      "into the rock; extent: between its corners farthest apart.</p>\n";
  std::size_t micro = 0;
  double micro_volume = 0;
  for (const stability::Judgement* j : judgements) {
    const topology::Block& block = page.complex->blocks()[j->block];
    if (!is_micro(block)) continue;
    ++micro;
    micro_volume += block.volume.si();
  }
  if (micro > 0) {
    out += "<input type=\"checkbox\" id=\"show-micro\"><label for=\"show-micro\" class=\"small\"> show " +
           display_count(micro) + (micro == 1 ? " block" : " blocks") + " below a litre or thinner than 1e-6 of the " +
           "domain too (" + display(micro_volume, 3) + " m³ in all, counted above)</label>\n";
  }
  out +=
      "<div class=\"scroll\"><table class=\"sortable\"><thead><tr><th>Block</th><th>Batch</th><th>Mode</th>"
      "<th>Where</th><th>Volume (m³)</th><th>Weight (kN)</th><th>Direction</th><th>Net force (kN)</th>"
      "<th>Factor of safety</th>";
  if (page.result.analysis->force_transfer) out += "<th>Net force, transferred (kN)</th><th>Factor, transferred</th>";
  if (page.result.field_stress) out += "<th>Factor, clamped by field stress</th>";
  if (page.result.analysis->rotation != stability::RotationCheck::off) out += "<th>Turns?</th>";
  out +=
      "<th>Free area (m²)</th><th>Depth (m)</th><th>Extent (m)</th><th>Faces</th><th>Sets</th><th "
      "class=\"wide\">Joints</th></tr></thead><tbody>\n";
  out += key_block_rows(page, judgements) + "</tbody></table></div>";
  if (page.result.field_stress) {
    const scene::FieldStressResult& f = *page.result.field_stress;
    out += "<p class=\"small\">Clamped: the same motion with the stress of the rock around “" + escape_xml(f.tunnel) +
           "” across the joints (elastic section, " + display_count(f.elements) +
           " boundary elements, estimated error " + display(f.error, 2) + "). " + display_count(f.held) +
           (f.held == 1 ? " block that would fall is" : " blocks that would fall are") +
           " held by it. The stress goes when the rock loosens: do not count on it for support.</p>";
  }
  return out + "</section>\n";
}

}  // namespace cleave::report
