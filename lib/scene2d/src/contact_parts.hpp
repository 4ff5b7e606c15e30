#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cleave/bem/problem.hpp"
#include "cleave/dbem/body.hpp"
#include "cleave/dbem/world.hpp"
#include "cleave/scene/table_reader.hpp"
#include "cleave/scene2d/contact.hpp"

/// The parts of a scene of contact beside its bodies.
namespace cleave::scene {

[[nodiscard]] const KeyTable& contact_keys();
void parse_settings(const TableReader& contact, ContactScene& scene);
/// `motion` of a fixed body.
[[nodiscard]] const KeyTable& support_motion_keys();
void parse_support_motion(const TableReader& body, ContactBody& spec);
[[nodiscard]] const KeyTable& contact_bolt_keys();
void parse_bolts(const TableReader& root, ContactScene& scene);
/// A bolt across a joint: the bar between two bodies that it is. Ends in the scene, at the start.
struct BoltBar {
  std::size_t first = 0, second = 0;  ///< bodies
  bem::Vec2 at_first, at_second;
  Stress stiffness{};
  ForcePerLength capacity{};
};
/// From the head on.
[[nodiscard]] std::vector<BoltBar> bars_of(const std::vector<ContactBody>& bodies, const ContactBolt& bolt);
/// What a bolt holds swings on it.
struct BoltSwing {
  std::string bolt;
  double period = 0;  ///< s
};
/// The fastest of a scene; empty: no bolt holds a body that is free.
[[nodiscard]] std::optional<BoltSwing> fastest_swing(const ContactScene& scene, const dbem::World& world);
/// All of them, bolt by bolt.
[[nodiscard]] std::vector<dbem::Tie> ties_of(const ContactScene& scene);
void parse_points(const TableReader& contact, ContactScene& scene);

[[nodiscard]] bool holds(const ContactBody& body, bem::Vec2 at);
/// On the outline, up to what rounding of written coordinates makes.
[[nodiscard]] bool lies_on(const ContactBody& body, bem::Vec2 at);

/// Longest element of an elastic body, m.
[[nodiscard]] double element_of(const ContactSettings& settings, const ContactBody& body);
/// Elements of the outline of an elastic body; a number that no mesh may have where `element` is far too short.
[[nodiscard]] double elements_of(const ContactSettings& settings, const ContactBody& body);

// What is wrong with the bodies together; each reports it.
void check_elastic(const ContactScene& scene, const TableReader& contact, Problems& problems);
void check_elements(const ContactScene& scene, const TableReader& contact, Problems& problems);
void check_forces(const ContactScene& scene, Problems& problems);
void check_rest(const ContactScene& scene, Problems& problems);
void check_overlaps(const ContactScene& scene, Problems& problems);
/// Levels that leave all bodies dry, or under water.
void note_water(const TableReader& root, const ContactScene& scene);

}  // namespace cleave::scene
