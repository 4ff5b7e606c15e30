#include "cleave/report/key_blocks.hpp"

#include <algorithm>
#include <vector>

#include "cleave/report/text.hpp"

namespace cleave::report {

std::vector<topology::JointId> joints_of(const topology::BlockComplex& complex, topology::BlockId block) {
  std::vector<topology::JointId> joints;
  for (const topology::FaceId id : complex.blocks()[block].faces) {
    const topology::Face& face = complex.faces()[id];
    if (face.joint) joints.push_back(*face.joint);
    for (const topology::Patch& patch : complex.patches(face)) {
      if (patch.joint) joints.push_back(*patch.joint);
    }
  }
  std::ranges::sort(joints);
  const auto repeated = std::ranges::unique(joints);
  joints.erase(repeated.begin(), repeated.end());
  return joints;
}

namespace {

/// A name with a comma, a quote or a line end would break the row.
std::string csv_text(std::string_view name) {
  if (name.find_first_of(",\"\n\r") == std::string_view::npos) return std::string{name};
  std::string out = "\"";
  for (const char c : name) out += c == '"' ? std::string{"\"\""} : std::string{c};
  return out + '"';
}

// A block that nothing was passed to keeps its values.
void append_transferred(std::string& out, const stability::Judgement& j) {
  const stability::Transferred after =
      j.transferred.value_or(stability::Transferred{.mode = j.mode,
                                                    .key = j.key,
                                                    .direction = j.direction,
                                                    .driving = j.driving,
                                                    .resistance = j.resistance,
                                                    .net = j.net,
                                                    .factor_of_safety = j.factor_of_safety});
  out += after.key ? ",1," : ",0,";
  out += stability::name(after.mode);
  for (const double value : {after.direction.x, after.direction.y, after.direction.z, after.net.si(),
                             after.factor_of_safety, after.passed.si(), after.lost}) {
    out += ',';
    append_number(out, value);
  }
}

/// Nothing where there is no value.
void append_optional(std::string& out, const std::optional<double>& value) {
  if (value) append_number(out, *value);
}

void append_supported(std::string& out, const stability::Judgement& j, const stability::SupportResult& support) {
  const auto found = std::ranges::lower_bound(support.blocks, j.block, {}, &stability::SupportedBlock::block);
  const bool listed = found != support.blocks.end() && found->block == j.block;
  if (!listed) {
    // Of a later batch: it stays when the first one is held. Otherwise it needs nothing.
    out += j.batch && *j.batch > 1 ? ",held by earlier batches,0,0," : ",none needed,0,0,";
    append_number(out, j.factor_of_safety);
    out += ",0,0,0";
    return;
  }
  out += ',';
  out += stability::name(found->held);
  out += ',' + std::to_string(found->bolts);
  out += ',';
  append_optional(out, found->mobilised);
  out += ',';
  append_optional(out, found->factor_with_support);
  for (const double value : {found->missing_force, found->required_force, found->required_pressure}) {
    out += ',';
    append_number(out, value);
  }
}

void append_clamped(std::string& out, const stability::Judgement& j, const scene::FieldStressResult& field) {
  const auto found = std::ranges::lower_bound(field.blocks, j.block, {}, &scene::ClampedBlock::block);
  if (found == field.blocks.end() || found->block != j.block) {
    out += ",,,,";
    return;
  }
  out += found->factor_of_safety < 1 ? ",1" : ",0";
  for (const double value : {found->factor_of_safety, found->compression, found->tension}) {
    out += ',';
    append_number(out, value);
  }
}

}  // namespace

std::string bolts_csv(const stability::SupportResult& support, std::span<const std::string> groups) {
  std::string out{
      "bolt,pattern,x,y,z,direction_x,direction_y,direction_z,length_m,status,limit,serves,capacity_n,used_n,blocks\n"};
  for (std::size_t i = 0; i < support.bolts.size(); ++i) {
    const stability::BoltResult& b = support.bolts[i];
    std::string group = b.spot ? "spot" : b.bolt.group < groups.size() ? groups[b.bolt.group] : "";
    std::ranges::replace_if(group, [](char c) { return c == ',' || c == '"' || c == '\n' || c == '\r'; }, ' ');
    out += std::to_string(i) + ',' + group;
    for (const double value : {b.bolt.collar.x, b.bolt.collar.y, b.bolt.collar.z, b.bolt.direction.x,
                               b.bolt.direction.y, b.bolt.direction.z, b.bolt.length}) {
      out += ',';
      append_number(out, value);
    }
    out += ',';
    out += stability::name(b.status);
    out += ',';
    if (b.capacity > 0) out += stability::name(b.limit);
    out += ',';
    if (b.serves) out += std::to_string(b.serves->value());
    for (const double value : {b.capacity, b.used}) {
      out += ',';
      append_number(out, value);
    }
    out += ',';
    for (std::size_t k = 0; k < b.pierced.size(); ++k) {
      out += (k == 0 ? "" : ";") + std::to_string(b.pierced[k].block.value()) + ':';
      append_number(out, b.pierced[k].from);
      out += '-';
      append_number(out, b.pierced[k].to);
    }
    out += '\n';
  }
  return out;
}

std::string key_blocks_csv(const topology::BlockComplex& complex, const stability::Analysis& analysis,
                           const stability::SupportResult* support, const scene::FieldStressResult* field_stress) {
  std::string out{key_blocks_header};
  if (analysis.force_transfer) out += key_blocks_transferred_header;
  if (analysis.rotation != stability::RotationCheck::off) out += key_blocks_rotation_header;
  if (support != nullptr) out += key_blocks_supported_header;
  if (field_stress != nullptr) out += key_blocks_clamped_header;
  out += '\n';
  for (const stability::Judgement& j : analysis.judgements) {
    if (!stability::moves(j.mode) && !j.key) continue;  // key without moving: it turns, and that was to decide
    const topology::Block& block = complex.blocks()[j.block];
    out += std::to_string(j.block.value()) + ',';
    if (j.batch) out += std::to_string(*j.batch);
    out += j.key ? ",1," : ",0,";
    out += stability::name(j.mode);
    for (const double value : {block.volume.si(), j.weight.si(), j.direction.x, j.direction.y, j.direction.z,
                               j.net.si(), j.factor_of_safety}) {
      out += ',';
      append_number(out, value);
    }
    out += ',' + std::to_string(block.faces.size()) + ',';
    bool first = true;
    for (const topology::JointId joint : joints_of(complex, j.block)) {
      if (!std::exchange(first, false)) out += ';';
      out += std::to_string(joint.value());
    }
    if (analysis.force_transfer) append_transferred(out, j);
    if (analysis.rotation != stability::RotationCheck::off) {
      out += !j.rotation ? "," : j.rotation->turns ? ",1" : ",0";
    }
    if (support != nullptr) append_supported(out, j, *support);
    if (field_stress != nullptr) append_clamped(out, j, *field_stress);
    out += '\n';
  }
  return out;
}

std::string support_blocks_csv(std::span<const NamedSupport> cases) {
  std::string out{
      "case,block,mode,target,net_force_n,factor_of_safety,held_by,bolts,factor_with_bolts,factor_with_shotcrete,"
      "factor_with_support,mobilised_share,missing_force_n,required_force_n,required_pressure_pa,free_area_m2,"
      "shotcrete_thickness_m\n"};
  for (const NamedSupport& load : cases) {
    for (const stability::SupportedBlock& b : load.support->blocks) {
      out += csv_text(load.name) + ',' + std::to_string(b.block.value()) + ',';
      out += stability::name(b.mode);
      for (const double value : {b.target, b.net_force, b.factor_of_safety}) {
        out += ',';
        append_number(out, value);
      }
      out += ',';
      out += stability::name(b.held);
      out += ',' + std::to_string(b.bolts);
      for (const double value : {b.factor_with_bolts, b.factor_with_shotcrete}) {
        out += ',';
        append_number(out, value);
      }
      for (const auto& value : {b.factor_with_support, b.mobilised}) {
        out += ',';
        append_optional(out, value);
      }
      for (const double value :
           {b.missing_force, b.required_force, b.required_pressure, b.free_area, b.needed_thickness}) {
        out += ',';
        append_number(out, value);
      }
      out += '\n';
    }
  }
  return out;
}

std::string combined_blocks_csv(std::span<const NamedSupport> cases) {
  std::string out{
      "case,body,members,volume_m3,removable,mode,target,net_force_n,factor_of_safety,bolts_leaving,"
      "bolt_force_n,factor_with_support,mobilised_share,passes,missing_force_n\n"};
  for (const NamedSupport& load : cases) {
    for (std::size_t i = 0; i < load.support->combined.size(); ++i) {
      const stability::CombinedBlock& b = load.support->combined[i];
      out += csv_text(load.name) + ',' + std::to_string(i) + ',';
      for (std::size_t k = 0; k < b.members.size(); ++k) {
        out += (k == 0 ? "" : ";") + std::to_string(b.members[k].value());
      }
      out += ',';
      append_number(out, b.volume);
      out += b.removable ? ",1," : ",0,";
      if (b.removable) out += stability::name(b.mode);
      for (const double value : {b.target, b.net_force, b.factor_of_safety}) {
        out += ',';
        append_number(out, value);
      }
      out += ',' + std::to_string(b.bolts) + ',';
      append_number(out, b.bolt_force);
      for (const auto& value : {b.factor_with_support, b.mobilised}) {
        out += ',';
        append_optional(out, value);
      }
      out += b.passes ? ",1," : ",0,";
      append_number(out, b.missing_force);
      out += '\n';
    }
  }
  return out;
}

std::string maximum_blocks_csv(std::span<const MaximumBlockRow> rows) {
  std::string out{
      "set_1,set_2,set_3,below,where,apex_right_m,apex_up_m,volume_m3,weight_n,height_m,face_area_m2,joint_area_1_m2,"
      "joint_area_2_m2,joint_area_3_m2,mode,direction_x,direction_y,direction_z,driving_n,resistance_n,net_force_n,"
      "factor_of_safety,target,required_pressure_pa\n"};
  for (const MaximumBlockRow& row : rows) {
    const stability::MaximumKeyBlock& b = row.block;
    for (const std::string& set : row.sets) out += csv_text(set) + ',';
    for (std::size_t i = 0; i < 3; ++i) out += ((b.block.code >> i) & 1U) != 0 ? '1' : '0';
    out += ',' + row.where;
    for (const double value : {b.block.apex[0], b.block.apex[1], b.block.volume, b.weight.si(), b.block.height,
                               b.block.face_area, b.areas[0], b.areas[1], b.areas[2]}) {
      out += ',';
      append_number(out, value);
    }
    out += ',';
    out += stability::name(b.mode);
    for (const double value : {b.direction.x, b.direction.y, b.direction.z, b.driving.si(), b.resistance.si(),
                               b.net.si(), b.factor_of_safety, b.target, b.required_pressure}) {
      out += ',';
      append_number(out, value);
    }
    out += '\n';
  }
  return out;
}

std::string load_cases_csv(const topology::BlockComplex& complex, std::span<const NamedAnalysis> cases) {
  std::string out{
      "case,block,batch,key,mode,volume_m3,direction_x,direction_y,direction_z,net_force_n,factor_of_safety\n"};
  for (const NamedAnalysis& load : cases) {
    for (const stability::Judgement& j : load.analysis->judgements) {
      if (!stability::moves(j.mode)) continue;
      out += csv_text(load.name) + ',' + std::to_string(j.block.value()) + ',';
      if (j.batch) out += std::to_string(*j.batch);
      out += j.key ? ",1," : ",0,";
      out += stability::name(j.mode);
      for (const double value : {complex.blocks()[j.block].volume.si(), j.direction.x, j.direction.y, j.direction.z,
                                 j.net.si(), j.factor_of_safety}) {
        out += ',';
        append_number(out, value);
      }
      out += '\n';
    }
  }
  return out;
}

}  // namespace cleave::report
