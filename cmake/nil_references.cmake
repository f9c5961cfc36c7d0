# cmake -DSTUBS=XSK.cc -DOUTPUT=XNil.cc -P nil_references.cmake: a source that makes the nil references of all interfaces in these stubs.
# The code that omniidl generates makes each when it is first asked for, and shows it to other threads before it is whole: so they are made
# while the library is loaded, before any thread can ask.
file(STRINGS ${STUBS} lines REGEX "^[A-Za-z0-9_:]+::_nil\\(\\)")
set(calls "")
foreach(line IN LISTS lines)
  string(REGEX REPLACE "::_nil\\(\\).*" "" interface "${line}")
  if(NOT interface MATCHES "_Helper$")
    string(APPEND calls "  ::${interface}::_nil();\n")
  endif()
endforeach()
file(WRITE ${OUTPUT} "namespace {\n[[maybe_unused]] const bool nil_references_are_made = [] {\n${calls}  return true;\n}();\n}\n")
