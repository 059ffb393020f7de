// Renderers written in Python as a plug-in (<touchstone/plugin.h>): the program, its conformance suite and the Python
// module load them like any other. In a process that is no Python's, an interpreter is started.
//
// All knowledge of renderers is in touchstone/renderer.py; here calls go from C to Python and back. A step takes the
// interpreter's lock and allocates: such a renderer is for trying an idea, not for a servo loop.
#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <dlfcn.h>
#include <touchstone/plugin.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <new>
#include <string>
#include <vector>

struct touchstone_renderer {
  PyObject* adapter = nullptr;  // touchstone.renderer's _Adapter
  std::string error;
};

namespace {

struct Release {
  void operator()(PyObject* object) const { Py_XDECREF(object); }
};
using Object = std::unique_ptr<PyObject, Release>;

// In a program that is no Python's. Extension modules such as numpy's look for the interpreter among the symbols of the
// program, where a plug-in does not bring it.
void start_python() {
  if (Py_IsInitialized()) return;
  Dl_info about{};
  if (::dladdr(reinterpret_cast<void*>(&Py_InitializeFromConfig), &about) != 0 && about.dli_fname != nullptr)
    ::dlopen(about.dli_fname, RTLD_NOW | RTLD_GLOBAL);
  PyConfig config;
  PyConfig_InitPythonConfig(&config);
  config.install_signal_handlers = 0;
  // Whatever Python comes first on the PATH: its packages are not this one's.
  PyConfig_SetString(&config, &config.program_name, TOUCHSTONE_PYTHON);
  const PyStatus status = Py_InitializeFromConfig(&config);
  PyConfig_Clear(&config);
  if (PyStatus_Exception(status)) Py_ExitStatusException(status);
  PyEval_SaveThread();
}

// The interpreter's lock, in any thread.
class Lock {
 public:
  Lock() : state_((start_python(), PyGILState_Ensure())) {}
  ~Lock() { PyGILState_Release(state_); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  PyGILState_STATE state_;
};

std::string text_of(PyObject* object) {
  const Object text(object == nullptr ? nullptr : PyObject_Str(object));
  const char* const utf8 = text ? PyUnicode_AsUTF8(text.get()) : nullptr;
  if (utf8 == nullptr) PyErr_Clear();
  return utf8 == nullptr ? "" : utf8;
}

// The exception that Python is about to raise, with the place where it was raised.
std::string take_exception() {
  PyObject* type = nullptr;
  PyObject* value = nullptr;
  PyObject* trace = nullptr;
  PyErr_Fetch(&type, &value, &trace);
  PyErr_NormalizeException(&type, &value, &trace);
  const Object held_type(type), held_value(value), held_trace(trace);
  if (type == nullptr) return "failed without an exception";
  const Object module(PyImport_ImportModule("touchstone.renderer"));
  const Object text(module ? PyObject_CallMethod(module.get(), "_describe_exception", "OO",
                                                 value == nullptr ? Py_None : value, trace == nullptr ? Py_None : trace)
                           : nullptr);
  if (text) return text_of(text.get());
  PyErr_Clear();
  return text_of(value);
}

// The module beside this file, where a Python that was started here would not find it.
Object adapter_module() {
  PyObject* module = PyImport_ImportModule("touchstone.renderer");
  if (module != nullptr) return Object(module);
  if (!PyErr_ExceptionMatches(PyExc_ImportError)) return {};
  Dl_info about{};
  if (::dladdr(reinterpret_cast<void*>(&start_python), &about) == 0 || about.dli_fname == nullptr) return {};
  const auto folder = std::filesystem::absolute(about.dli_fname).parent_path().parent_path().string();
  PyObject* const path = PySys_GetObject("path");
  const Object entry(PyUnicode_FromString(folder.c_str()));
  if (path == nullptr || !entry || PyList_Append(path, entry.get()) != 0) return {};
  PyErr_Clear();
  return Object(PyImport_ImportModule("touchstone.renderer"));
}

std::string& creation_error() {
  thread_local std::string error;
  return error;
}

// One kind of renderer as the plug-in interface describes it, with its texts.
struct Described {
  std::vector<std::string> texts;
  std::vector<touchstone_parameter> parameters;
  std::vector<touchstone_limitation> limitations;
  touchstone_description description{};
};

// A tuple of texts and numbers. False: it is none.
bool read_description(PyObject* of, Described& out) {
  const char* name = nullptr;
  const char* summary = nullptr;
  const char* source = nullptr;
  PyObject* parameters = nullptr;
  PyObject* limitations = nullptr;
  if (!PyArg_ParseTuple(of, "sssO!O!", &name, &summary, &source, &PyList_Type, &parameters, &PyList_Type, &limitations))
    return false;
  const auto parameter_count = static_cast<std::size_t>(PyList_Size(parameters));
  const auto limitation_count = static_cast<std::size_t>(PyList_Size(limitations));
  out.texts.reserve(3 + 3 * parameter_count + 2 * limitation_count);  // pointers into it stay
  const auto keep = [&](const char* text) { return out.texts.emplace_back(text).c_str(); };
  out.description = {TOUCHSTONE_PLUGIN_SIZES, keep(name), keep(summary), keep(source), nullptr, 0, nullptr, 0};
  for (std::size_t i = 0; i < parameter_count; ++i) {
    const char* unit = nullptr;
    const char* meaning = nullptr;
    touchstone_parameter one{};
    if (!PyArg_ParseTuple(PyList_GetItem(parameters, static_cast<Py_ssize_t>(i)), "ssddds", &name, &unit, &one.minimum,
                          &one.maximum, &one.initial, &meaning))
      return false;
    one.name = keep(name);
    one.unit = keep(unit);
    one.meaning = keep(meaning);
    out.parameters.push_back(one);
  }
  for (std::size_t i = 0; i < limitation_count; ++i) {
    const char* ability = nullptr;
    const char* reason = nullptr;
    if (!PyArg_ParseTuple(PyList_GetItem(limitations, static_cast<Py_ssize_t>(i)), "ss", &ability, &reason))
      return false;
    const char* const kept = keep(ability);
    out.limitations.push_back({kept, keep(reason)});
  }
  out.description.parameters = out.parameters.data();
  out.description.parameter_count = out.parameters.size();
  out.description.limitations = out.limitations.data();
  out.description.limitation_count = out.limitations.size();
  return true;
}

Object create_adapter(const touchstone_creation& creation) {
  const Object module = adapter_module();
  if (!module) return {};
  const auto memory = [](const void* data, std::size_t bytes) {
    return PyMemoryView_FromMemory(static_cast<char*>(const_cast<void*>(data)), static_cast<Py_ssize_t>(bytes),
                                   PyBUF_READ);
  };
  const Object parameters(memory(creation.parameters, creation.parameter_count * sizeof(double)));
  const Object vertices(memory(creation.vertices_W_m, 3 * creation.vertex_count * sizeof(double)));
  const Object triangles(memory(creation.triangles, 3 * creation.triangle_count * sizeof(std::int32_t)));
  if (!parameters || !vertices || !triangles) return {};
  return Object(PyObject_CallMethod(module.get(), "_create", "IOOO", creation.index, parameters.get(), vertices.get(),
                                    triangles.get()));
}

// f, contact, normal, depth, contact state: eleven numbers.
bool read_result(PyObject* from, touchstone_result& result) {
  int contact = 0;
  const bool good = PyArg_ParseTuple(from, "ddddddddddp", &result.f_W_N[0], &result.f_W_N[1], &result.f_W_N[2],
                                     &result.contact_W_m[0], &result.contact_W_m[1], &result.contact_W_m[2],
                                     &result.n_W[0], &result.n_W[1], &result.n_W[2], &result.depth_m, &contact) != 0;
  result.contact = contact;
  result.reserved = 0;
  return good;
}

}  // namespace

uint32_t touchstone_plugin_version(void) { return TOUCHSTONE_PLUGIN_VERSION; }

const touchstone_description* touchstone_describe(uint32_t index) {
  const Lock lock;
  const Object module = adapter_module();
  const Object about(module ? PyObject_CallMethod(module.get(), "_description", "I", index) : nullptr);
  if (!about) {
    PySys_WriteStderr("touchstone: %s\n", take_exception().c_str());
    return nullptr;
  }
  if (about.get() == Py_None) return nullptr;
  // A class that is defined anew in a notebook has a new description; the old one stays for who still uses it.
  static std::vector<std::unique_ptr<Described>> all;
  auto described = std::make_unique<Described>();
  if (!read_description(about.get(), *described)) {
    PySys_WriteStderr("touchstone: %s\n", take_exception().c_str());
    return nullptr;
  }
  all.push_back(std::move(described));
  return &all.back()->description;
}

touchstone_renderer* touchstone_create(const touchstone_creation* creation) {
  const Lock lock;
  Object adapter = create_adapter(*creation);
  if (!adapter) {
    creation_error() = take_exception();
    return nullptr;
  }
  auto* const renderer = new (std::nothrow) touchstone_renderer;
  if (renderer != nullptr) renderer->adapter = adapter.release();
  return renderer;
}

int touchstone_reset(touchstone_renderer* renderer) {
  const Lock lock;
  const Object done(PyObject_CallMethod(renderer->adapter, "reset", nullptr));
  if (done) return 0;
  renderer->error = take_exception();
  return 1;
}

int touchstone_step(touchstone_renderer* renderer, const touchstone_tip* tip, touchstone_result* result) {
  const Lock lock;
  const Object answer(PyObject_CallMethod(renderer->adapter, "step", "dddddddd", tip->t_s, tip->p_W_m[0], tip->p_W_m[1],
                                          tip->p_W_m[2], tip->q_WS[0], tip->q_WS[1], tip->q_WS[2], tip->q_WS[3]));
  if (answer && PyTuple_Check(answer.get()) && read_result(answer.get(), *result)) return 0;
  renderer->error = take_exception();
  return 1;
}

void touchstone_destroy(touchstone_renderer* renderer) {
  {
    const Lock lock;
    Py_XDECREF(renderer->adapter);
  }
  delete renderer;
}

const char* touchstone_error(const touchstone_renderer* renderer) {
  return renderer == nullptr ? creation_error().c_str() : renderer->error.c_str();
}
