# Run at build time: text files become functions of a C++ source.
# cmake -DOUTPUT=… -DHEADER=… -DNAMESPACE=… -DNAMES=a,b -DFILES=/…/a.js,/…/b.css -P embed.cmake
# The header declares, in that namespace, std::string_view NAME() noexcept for each name.
string(REPLACE "," ";" names "${NAMES}")
string(REPLACE "," ";" files "${FILES}")
set(source "#include \"${HEADER}\"\n\nnamespace ${NAMESPACE} {\n")
foreach(name file IN ZIP_LISTS names files)
  file(READ "${file}" text)
  string(FIND "${text}" ")stickslip\"" mark)
  if(NOT mark EQUAL -1)
    message(FATAL_ERROR "${file} holds the mark that ends a C++ raw string here")
  endif()
  string(APPEND source "\nstd::string_view ${name}() noexcept {\n  static constexpr char kText[] = R\"stickslip(${text})stickslip\";\n  return {kText, sizeof kText - 1};\n}\n")
endforeach()
string(APPEND source "\n}  // namespace ${NAMESPACE}\n")
file(WRITE "${OUTPUT}" "${source}")
