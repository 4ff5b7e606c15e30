#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/core/version.hpp"
#include "cleave/exchange/exports.hpp"
#include "cleave/report/write.hpp"
#include "result.hpp"

namespace cleave::python {
namespace {

using scene::Problem;

/// Text of files may be in any encoding, and Python takes UTF-8 alone.
py::str text_of(const std::string& text) {
  PyObject* made = PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace");
  if (made == nullptr) throw py::error_already_set{};
  return py::reinterpret_steal<py::str>(made);
}
py::tuple tuple_of(const Problem& p) {
  return py::make_tuple(text_of(p.file), p.line, text_of(p.key), text_of(p.what), text_of(p.remedy));
}

/// What the Python side makes exceptions of.
[[noreturn]] void refuse(const std::vector<Problem>& problems) {
  py::list all;
  for (const Problem& p : problems) all.append(tuple_of(p));
  py::module_::import("cleave").attr("_refuse")(all);
  throw std::logic_error{"cleave._refuse came back"};
}
[[noreturn]] void fail(const std::string& what) {
  PyErr_SetString(py::module_::import("cleave").attr("MachineError").ptr(), what.c_str());
  throw py::error_already_set{};
}

/// A result and what is made of it once.
class Result {
 public:
  explicit Result(AnyResult any) : any_{std::move(any)} {}
  [[nodiscard]] const AnyResult& any() const noexcept { return any_; }

  [[nodiscard]] const topology::BlockComplex& complex() const {
    const auto* run = std::get_if<scene::RunResult>(&any_);
    if (run == nullptr) throw py::attribute_error{"a " + std::string{kind_of(any_)} + " result has no block system"};
    if (!run->complex) throw py::attribute_error{"the block system did not pass its own check; see `complaint`"};
    return run->complex->complex();
  }
  [[nodiscard]] const std::vector<geometry::Vec3>& points() {
    if (!points_) {
      points_.emplace();
      const auto& all = complex();
      for (const topology::VertexId v : all.vertices().ids()) points_->push_back(all.position(v));
    }
    return *points_;
  }
  [[nodiscard]] const std::vector<topology::Face>& faces() {
    if (!faces_) {
      faces_.emplace();
      for (const topology::Face& face : complex().faces()) faces_->push_back(face);
    }
    return *faces_;
  }
  [[nodiscard]] const report::Cells& cells() {
    if (!cells_) cells_ = report::make_cells(complex());
    return *cells_;
  }
  struct Links {
    std::vector<std::int32_t> joint, excavation;  ///< of faces; -1: none
    std::vector<std::int64_t> loop_starts, corners;
  };
  [[nodiscard]] const Links& links() {
    if (links_) return *links_;
    Links made;
    const auto& all = complex();
    const auto number = [](const auto& id) { return id ? static_cast<std::int32_t>(id->value()) : -1; };
    for (const topology::Face& face : all.faces()) {
      made.joint.push_back(number(face.joint));
      made.excavation.push_back(face.excavation ? static_cast<std::int32_t>(*face.excavation) : -1);
    }
    return links_.emplace(std::move(made));
  }

 private:
  AnyResult any_;
  std::optional<std::vector<geometry::Vec3>> points_;
  std::optional<std::vector<topology::Face>> faces_;
  std::optional<report::Cells> cells_;
  std::optional<Links> links_;
};

/// Runs on a thread of its own while this one lets Python live: signals are seen, progress is reported.
Result run_watched(const std::string& text, const std::string& shown, const std::filesystem::path& folder,
                   const RunSettings& settings, const py::object& progress) {
  auto loaded = [&] {
    const py::gil_scoped_release released;
    return scene::load_text(text, shown, folder);
  }();
  if (!loaded) refuse(loaded.error());
  Progress state{ProgressStyle::quiet, [](std::string_view) {}, [] { return 0.0; }};
  std::optional<std::expected<AnyResult, RunFailure>> made;
  std::exception_ptr thrown;
  std::atomic<bool> over{false};
  {
    std::jthread worker{[&] {
      try {
        made.emplace(run(*std::move(loaded), settings, state));
      } catch (...) {
        thrown = std::current_exception();
      }
      over = true;
    }};
    struct StopOnTheWayOut {
      Progress& progress;
      ~StopOnTheWayOut() { progress.stop(); }
    } stop{state};
    int pause_ms = 1;
    while (!over) {
      {
        const py::gil_scoped_release released;
        std::this_thread::sleep_for(std::chrono::milliseconds{pause_ms});
      }
      pause_ms = std::min(2 * pause_ms, 50);
      if (PyErr_CheckSignals() != 0) throw py::error_already_set{};
      if (progress.is_none()) continue;
      if (const auto seen = state.seen()) {
        const py::object share =
            seen->total == 0
                ? py::object{py::none()}
                : py::object{py::float_(static_cast<double>(seen->done) / static_cast<double>(seen->total))};
        progress(seen->stage, share);  // what it raises ends the run
      }
    }
  }
  if (thrown) std::rethrow_exception(thrown);
  if (!*made) {
    if (const auto* problems = std::get_if<std::vector<Problem>>(&made->error())) refuse(*problems);
    fail(std::get<std::string>(made->error()));
  }
  return Result{**std::move(made)};
}

std::vector<py::tuple> problems_of(const std::string& text, const std::string& shown,
                                   const std::filesystem::path& folder) {
  std::vector<py::tuple> all;
  const auto loaded = scene::load_text(text, shown, folder);
  if (loaded) return all;
  for (const Problem& p : loaded.error()) all.push_back(tuple_of(p));
  return all;
}

py::dict block_arrays(const py::object& self) {
  const std::span<const topology::Block> items = self.cast<Result&>().complex().blocks().items();
  using topology::Block;
  py::dict arrays;
  arrays["volume"] = column<double>(items, [](const Block& b) -> const auto& { return b.volume; }, self);
  arrays["centroid"] = vectors(items, [](const Block& b) -> const auto& { return b.centroid; }, self);
  arrays["thickness"] = column<double>(items, [](const Block& b) -> const auto& { return b.thickness; }, self);
  arrays["convex"] = column<bool>(items, [](const Block& b) -> const auto& { return b.convex; }, self);
  arrays["fixed"] = column<bool>(items, [](const Block& b) -> const auto& { return b.fixed; }, self);
  arrays["free"] = column<bool>(items, [](const Block& b) -> const auto& { return b.free; }, self);
  arrays["vertices"] =
      column<std::uint32_t>(items, [](const Block& b) -> const auto& { return b.counts.vertices; }, self);
  arrays["edges"] = column<std::uint32_t>(items, [](const Block& b) -> const auto& { return b.counts.edges; }, self);
  arrays["faces"] = column<std::uint32_t>(items, [](const Block& b) -> const auto& { return b.counts.faces; }, self);
  return arrays;
}

py::dict face_arrays(const py::object& self) {
  auto& result = self.cast<Result&>();
  const std::span<const topology::Face> items = result.faces();
  using topology::Face;
  py::dict arrays;
  arrays["block"] = column<std::uint32_t>(items, [](const Face& f) -> const auto& { return f.block; }, self);
  arrays["plane"] = column<std::uint32_t>(items, [](const Face& f) -> const auto& { return f.plane; }, self);
  arrays["role"] = column<std::uint8_t>(items, [](const Face& f) -> const auto& { return f.role; }, self);
  arrays["area"] = column<double>(items, [](const Face& f) -> const auto& { return f.area; }, self);
  arrays["centroid"] = vectors(items, [](const Face& f) -> const auto& { return f.centroid; }, self);
  arrays["normal"] = vectors(items, [](const Face& f) -> const auto& { return f.outward; }, self);
  arrays["joint"] = numbers<std::int32_t>(result.links().joint, self);
  arrays["excavation"] = numbers<std::int32_t>(result.links().excavation, self);
  return arrays;
}

/// Corners of face `number`: the outer loop, then holes, as indices into `points`.
std::vector<std::vector<std::uint32_t>> loops_of(Result& result, std::size_t number) {
  const auto& complex = result.complex();
  if (number >= complex.faces().size())
    throw py::index_error{"there are " + std::to_string(complex.faces().size()) + " faces"};
  std::vector<std::vector<std::uint32_t>> loops;
  for (const auto loop : complex.loops(complex.faces()[topology::FaceId{number}])) {
    auto& corners = loops.emplace_back();
    for (const topology::VertexId v : loop) corners.push_back(v.value());
  }
  return loops;
}

/// Closed polyhedra as VTK and PyVista take them.
py::dict cell_arrays(const py::object& self) {
  const report::Cells& cells = self.cast<Result&>().cells();
  py::dict arrays;
  arrays["points"] =
      vectors(std::span{std::as_const(cells.points)}, [](const geometry::Vec3& p) -> const auto& { return p; }, self);
  arrays["face_stream"] = numbers<std::int64_t>(cells.face_stream, self);
  arrays["face_ends"] = numbers<std::int64_t>(cells.face_ends, self);
  arrays["block"] = column<std::uint32_t>(
      std::span{std::as_const(cells.block)}, [](const topology::BlockId& b) -> const auto& { return b; }, self);
  arrays["volume"] = numbers<double>(cells.volume, self);
  return arrays;
}

void write_to(const Result& result, const std::filesystem::path& folder) {
  const auto written = [&] {
    const py::gil_scoped_release released;
    return write(result.any(), folder);
  }();
  if (!written) fail(report::describe(written.error()));
}

}  // namespace

PYBIND11_MODULE(_cleave, m) {
  m.doc() = "The compiled part of cleave; use `import cleave`.";
  m.attr("version") = std::string{version};
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const std::system_error& machine) {
      PyErr_SetString(py::module_::import("cleave").attr("MachineError").ptr(), machine.what());
    } catch (const Stopped&) {
      PyErr_SetString(PyExc_KeyboardInterrupt, "stopped");
    }
  });
  py::class_<Result>(m, "Result")
      .def_property_readonly("kind", [](const Result& r) { return kind_of(r.any()); })
      .def_property_readonly("summary_json", [](const Result& r) { return summary_of(r.any()); })
      .def_property_readonly("notes", [](const Result& r) { return notes_of(r.any()); })
      .def_property_readonly("complaint", [](const Result& r) { return complaint_of(r.any()); })
      .def_property_readonly("points",
                             [](const py::object& self) {
                               const std::span<const geometry::Vec3> all = self.cast<Result&>().points();
                               return vectors(all, [](const geometry::Vec3& p) -> const auto& { return p; }, self);
                             })
      .def("block_arrays", [](const py::object& self) { return block_arrays(self); })
      .def("face_arrays", [](const py::object& self) { return face_arrays(self); })
      .def("cell_arrays", [](const py::object& self) { return cell_arrays(self); })
      .def("loops", &loops_of)
      .def("text", [](const Result& r, const std::string& name) { return text_of(r.any(), name); })
      .def("write", &write_to);
  m.def("run", [](const std::string& text, const std::string& shown, const std::filesystem::path& folder,
                  std::optional<std::uint64_t> seed, unsigned threads, const py::object& progress) {
    return run_watched(text, shown, folder, {.seed = seed, .threads = std::max(1U, threads)}, progress);
  });
  m.def("problems", &problems_of);
}

}  // namespace cleave::python
