# Run at every build: writes version.cpp, and the changelog of the package, anew only if the commit has changed.
# cmake -DSOURCE_DIR=… -DTEMPLATE=… -DOUTPUT=… -DPROJECT_VERSION=… -P version.cmake
set(STICKSLIP_COMMIT "unknown")
# Without git, or where git refuses the owner of the folder: a source archive has the date of its change log.
file(STRINGS ${SOURCE_DIR}/CHANGELOG.md heading REGEX "^## .*[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]" LIMIT_COUNT 1)
string(REGEX MATCH "[0-9]+-[0-9]+-[0-9]+" dated "${heading}")
execute_process(COMMAND date --utc --rfc-email --date=${dated} OUTPUT_VARIABLE STICKSLIP_DATE OUTPUT_STRIP_TRAILING_WHITESPACE
  COMMAND_ERROR_IS_FATAL ANY)
find_package(Git QUIET)
if(Git_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} describe --always --dirty --abbrev=12 --exclude=*
    WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE DESCRIBED OUTPUT_STRIP_TRAILING_WHITESPACE
    ERROR_QUIET RESULT_VARIABLE STATUS)
  if(STATUS EQUAL 0)
    set(STICKSLIP_COMMIT "${DESCRIBED}")
  endif()
  execute_process(COMMAND ${GIT_EXECUTABLE} log -1 --format=%cd --date=rfc WORKING_DIRECTORY ${SOURCE_DIR}
    OUTPUT_VARIABLE DATED OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE STATUS)
  if(STATUS EQUAL 0)
    set(STICKSLIP_DATE "${DATED}")
  endif()
endif()
configure_file(${TEMPLATE} ${OUTPUT} @ONLY)
