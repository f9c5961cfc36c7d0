// Modules of Python get a host process of their own: rtcd becomes python3, with the same words, when one of its modules is a file *.py.
// That process is Python's from its first moment, so its main thread is Python's main thread, extension modules find their symbols, and
// nothing of it is in the hosts of other components. One thread.
#pragma once

#include <string>
#include <vector>

// Whether one of the modules is one of Python: by its suffix, or because a folder of the load path has no library of that name but a file
// *.py. A module is a name, a path, `name(function)` or `Type?key=value`.
bool is_for_python(const std::vector<std::string>& modules, const std::vector<std::string>& load_path);

// Becomes `python3 -m OpenRTM_aist.rtcd OPTIONS -- MODULES`. Returns only when that fails, with the reason.
std::string become_python(const std::vector<std::string>& options, const std::vector<std::string>& modules);
