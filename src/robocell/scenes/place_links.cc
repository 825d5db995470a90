#include "robocell/scenes/place_links.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/scenes/object_places.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/validate.h"

namespace robocell::internal {
namespace {

// What of a start a name stands for.
std::optional<size_t> Named(const std::string& name, const StartObjects& start) {
  for (size_t i = 0; i < start.objects.size(); ++i) {
    if (start.objects[i].name == name) return i;
  }
  return std::nullopt;
}

// The first of a kind, but for the object that asks.
std::optional<size_t> OfKind(const std::string& kind, const StartObjects& start, size_t except) {
  for (size_t i = 0; i < start.kinds.size(); ++i) {
    if (i != except && start.kinds[i] == kind) return i;
  }
  return std::nullopt;
}

bool IsKind(const std::string& name, const StartObjects& start) {
  return std::ranges::find(start.kinds, name) != start.kinds.end();
}

std::vector<std::string> NamesOf(const StartObjects& start) {
  std::vector<std::string> names;
  for (const SceneObject& object : start.objects) names.push_back(object.name);
  for (const std::string& kind : start.kinds) {
    if (std::ranges::find(names, kind) == names.end()) names.push_back(kind);
  }
  return names;
}

void RequireValid(const SaidPlaces& said, const StartObjects& start) {
  for (const auto& [key, place] : said.places.entries()) {
    Problems problems;
    ValidateFields(*place, problems);
    if (!problems.empty())
      throw SpecError(said.where(key) + ": " +
                      fmt::format("{}", fmt::join(LinesOf(problems), "; ")));
    if (Named(key, start) || IsKind(key, start) || start.may_come(key)) continue;
    throw SpecError(NoSuchName(said.where(""), "object", key, NamesOf(start)));
  }
}

// The entry for an object.
struct Entry {
  const SaidPlaces* said;
  std::string key;
  const ObjectPlace* place;
};

std::optional<Entry> EntryOf(std::span<const SaidPlaces> said, const StartObjects& start,
                             size_t i) {
  for (const SaidPlaces& each : said) {
    for (const std::string& key : {start.objects[i].name, start.kinds[i]}) {
      if (const ObjectPlace* place = each.places.find(key)) return Entry{&each, key, place};
    }
  }
  return std::nullopt;
}

// An object as it stands alone at the origin.
std::shared_ptr<const Landmarks> Alone(SceneObject object) {
  object.fixed = true;
  object.pos = {0, 0, 0};
  object.euler = {};
  object.quat = kIdentityQuat;
  object.reset_root_pose = true;
  SceneSpec spec{.name = "'" + object.name + "' alone",
                 .timestep = 0.002,
                 .add_floor = false,
                 .add_skybox = false};
  spec.objects.push_back(std::move(object));
  return LandmarksOf(spec);
}

// Objects that are measured alone, each once.
class Measured {
 public:
  explicit Measured(const StartObjects& start) : start_(start), alone_(start.objects.size()) {}
  const std::shared_ptr<const Landmarks>& Of(size_t i) {
    if (!alone_[i]) alone_[i] = Alone(start_.objects[i]);
    return alone_[i];
  }

 private:
  const StartObjects& start_;
  std::vector<std::shared_ptr<const Landmarks>> alone_;
};

void RequirePlace(const PlaceLink& link, const std::string& where) {
  const std::string& name = link.place.reference();
  const Relation relation = link.place.relation();
  if (relation != Relation::kInside && link.marks->Tops(link.mark).empty()) {
    throw SpecError(fmt::format("{}: nothing can lie {} '{}', which has no shape that collides",
                                where, ToString(relation), name));
  }
  if (relation == Relation::kInside && link.marks->Floors(link.mark).empty()) {
    throw SpecError(
        fmt::format("{}: '{}' has no hollow with a level floor. Say on_top_of, or let "
                    "the source of the scene name a container (annotations)",
                    where, name));
  }
  if (relation == Relation::kNextTo && !link.other && link.marks->Ground(link.mark).half_x <= 0) {
    throw SpecError(fmt::format(
        "{}: it is not known what '{}' stands on: no level face of a box and no floor is under it. "
        "Let the source of the scene name a support there (annotations)",
        where, name));
  }
}

// The link of an object; unset when it has no entry, or one by kind that refers to itself.
std::optional<PlaceLink> LinkOf(size_t i, const std::shared_ptr<const Landmarks>& base,
                                std::span<const SaidPlaces> said, const StartObjects& start,
                                Measured& measured) {
  const std::optional<Entry> entry = EntryOf(said, start, i);
  if (!entry) return std::nullopt;
  const SceneObject& object = start.objects[i];
  const std::string where = entry->said->where(entry->key);
  const std::string& reference = entry->place->reference();
  PlaceLink link{.object = i, .place = *entry->place, .other = Named(reference, start)};
  if (link.other == i && entry->key != object.name) return std::nullopt;
  if (link.other == i) throw SpecError(where + ": it cannot have its place by itself");
  if (IsFixed(object))
    throw SpecError(where + ": it is a fixed object, which stays where its pose is");
  if (!link.other) link.other = OfKind(reference, start, i);
  if (link.other) {
    link.marks = measured.Of(*link.other);
    link.mark = start.objects[*link.other].name;
  } else if (base->Has(reference)) {
    link.marks = base;
    link.mark = reference;
  } else if (!start.may_come(reference) && !IsKind(reference, start)) {
    std::vector<std::string> known = NamesOf(start);
    const std::vector<std::string> bodies = base->Names();
    known.insert(known.end(), bodies.begin(), bodies.end());
    throw SpecError(NoSuchName(where, "object or body", reference, known));
  }
  if (link.marks) RequirePlace(link, where);
  if (link.place.relation() == Relation::kNextTo) link.own = measured.Of(i);
  return link;
}

// Each after those that it refers to.
std::vector<PlaceLink> InOrder(std::vector<PlaceLink> links, const std::string& where,
                               const std::vector<SceneObject>& objects) {
  std::vector<PlaceLink> ordered;
  while (!links.empty()) {
    const auto waits = [&](const PlaceLink& link) {
      return std::ranges::any_of(links, [&](const PlaceLink& l) { return link.other == l.object; });
    };
    const auto next = std::ranges::find_if_not(links, waits);
    if (next == links.end()) {
      std::vector<std::string> circle;
      for (const PlaceLink& link : links) circle.push_back(TextOf(link, objects));
      throw SpecError(fmt::format(
          "{}: these run in a circle: {}. Let one of them lie on the support, without a place of "
          "its own",
          where, fmt::join(circle, ", ")));
    }
    ordered.push_back(std::move(*next));
    links.erase(next);
  }
  return ordered;
}

}  // namespace

std::shared_ptr<const Landmarks> LandmarksOf(const SceneSpec& scene,
                                             const std::optional<SceneAnnotations>& known) {
  SceneAnnotations annotations = DeriveAnnotations(scene);
  if (known && !known->supports.empty()) annotations.supports = known->supports;
  if (known && !known->containers.empty()) annotations.containers = known->containers;
  return std::make_shared<const Landmarks>(Scene::Build(scene), std::move(annotations));
}

std::string TextOf(const PlaceLink& link, const std::vector<SceneObject>& objects) {
  return fmt::format("'{}' {} '{}'", objects[link.object].name, ToString(link.place.relation()),
                     link.place.reference());
}

std::vector<PlaceLink> LinkPlaces(const std::shared_ptr<const Landmarks>& base,
                                  std::span<const SaidPlaces> said, const StartObjects& start) {
  for (const SaidPlaces& each : said) RequireValid(each, start);
  Measured measured(start);
  std::vector<PlaceLink> links;
  for (size_t i = 0; i < start.objects.size(); ++i) {
    if (auto link = LinkOf(i, base, said, start, measured)) links.push_back(*std::move(link));
  }
  return InOrder(std::move(links), said.empty() ? "" : said.front().where(""), start.objects);
}

}  // namespace robocell::internal
