# The Debian package: `./dev package`. Paths are those of the machine it is installed on, below "/"; what needs a shell
# (user, service, udev) is in package/.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON) # Tests are not part of it, and need not be built for it.

install(TARGETS stickslip stickslipd RUNTIME DESTINATION usr/bin)
# All symbols at start, and what the loader wrote read-only from then on.
foreach(program stickslip stickslipd)
  target_link_options(${program} PRIVATE LINKER:-z,relro,-z,now)
endforeach()

install(FILES config/bench.toml DESTINATION etc/stickslip RENAME stickslipd.toml)
install(DIRECTORY config/scenes config/methods DESTINATION usr/share/stickslip FILES_MATCHING PATTERN "*.toml")
install(FILES config/demo.toml DESTINATION usr/share/stickslip)
install(DIRECTORY ${CMAKE_BINARY_DIR}/share/stickslip/pages DESTINATION usr/share/stickslip)

install(FILES systemd/stickslipd.service systemd/stickslipd.socket DESTINATION lib/systemd/system)
install(FILES systemd/sysusers.conf DESTINATION usr/lib/sysusers.d RENAME stickslip.conf)
install(FILES systemd/tmpfiles.conf DESTINATION usr/lib/tmpfiles.d RENAME stickslip.conf)
install(FILES systemd/udev.rules DESTINATION lib/udev/rules.d RENAME 60-stickslip.rules)

# Compressed as Debian asks; without time and name, so that the bits are the same each time.
function(stickslip_install_compressed file destination name)
  set(compressed ${CMAKE_BINARY_DIR}/package/${name}.gz)
  get_filename_component(folder ${compressed} DIRECTORY)
  add_custom_command(OUTPUT ${compressed}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${folder}
    COMMAND gzip -9nc ${file} > ${compressed}
    DEPENDS ${file} VERBATIM)
  set_property(GLOBAL APPEND PROPERTY STICKSLIP_COMPRESSED ${compressed})
  install(FILES ${compressed} DESTINATION ${destination})
endfunction()
foreach(section 1 5 8)
  set(page_1 stickslip.1)
  set(page_5 stickslipd.toml.5)
  set(page_8 stickslipd.8)
  stickslip_install_compressed(${CMAKE_BINARY_DIR}/man/${page_${section}} usr/share/man/man${section} ${page_${section}})
endforeach()
stickslip_install_compressed(${CMAKE_SOURCE_DIR}/CHANGELOG.md usr/share/doc/stickslip changelog)

# Of the package itself. Its date is that of the last commit, which is asked each time.
set(debian_changelog ${CMAKE_BINARY_DIR}/package/debian_changelog)
add_custom_target(package_changelog
  COMMAND ${CMAKE_COMMAND} -DSOURCE_DIR=${CMAKE_SOURCE_DIR} -DTEMPLATE=${CMAKE_SOURCE_DIR}/package/changelog.in
    -DOUTPUT=${debian_changelog} -DPROJECT_VERSION=${PROJECT_VERSION} -P ${CMAKE_SOURCE_DIR}/cmake/version.cmake
  BYPRODUCTS ${debian_changelog} VERBATIM)
stickslip_install_compressed(${debian_changelog} usr/share/doc/stickslip changelog.Debian)
get_property(compressed GLOBAL PROPERTY STICKSLIP_COMPRESSED)
add_custom_target(package_files DEPENDS ${compressed})
add_dependencies(package_files manual pages package_changelog)

install(FILES package/copyright README.md SECURITY.md DESTINATION usr/share/doc/stickslip)
install(DIRECTORY docs DESTINATION usr/share/doc/stickslip FILES_MATCHING PATTERN "*.md")
install(FILES ${CMAKE_BINARY_DIR}/completions/stickslip.bash
  DESTINATION usr/share/bash-completion/completions RENAME stickslip)
install(FILES ${CMAKE_BINARY_DIR}/completions/_stickslip DESTINATION usr/share/zsh/vendor-completions)
install(FILES ${CMAKE_BINARY_DIR}/completions/stickslip.fish DESTINATION usr/share/fish/vendor_completions.d)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX "/")
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PACKAGE_NAME stickslip)
set(CPACK_PACKAGE_CONTACT "the stickslip authors <stickslip@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "friction tester that understands stick-slip")
set(CPACK_PACKAGE_DESCRIPTION
  "stickslipd reads the load cell of a paper friction tester through an A/D
board (Linux Comedi), notices tests by itself, tells stick-slip from ring-down
and steady sliding, estimates the friction law with its uncertainty, and
writes one HDF5 record per test.
.
Without hardware it runs on an exact simulation of the tester: stickslip demo.")
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "systemd (>= 252), udev")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "gnuplot-nox")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA
  "${CMAKE_SOURCE_DIR}/package/conffiles;${CMAKE_SOURCE_DIR}/package/postinst;${CMAKE_SOURCE_DIR}/package/prerm;${CMAKE_SOURCE_DIR}/package/postrm")
include(CPack)
