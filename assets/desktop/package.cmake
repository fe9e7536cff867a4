# What a desktop wants of an installed program, and the Debian package (`./run package`).
install(FILES assets/desktop/limber.desktop DESTINATION share/applications)
install(FILES assets/desktop/limber.xml DESTINATION share/mime/packages)
install(FILES assets/desktop/limber.svg DESTINATION share/icons/hicolor/scalable/apps)
install(FILES assets/desktop/limber.bash DESTINATION share/bash-completion/completions RENAME limber)
# The pages are made of --help by the program that is installed.
install(CODE "execute_process(COMMAND ${CMAKE_SOURCE_DIR}/core/cmd/man_pages.sh ${CMAKE_BINARY_DIR}/limber ${CMAKE_BINARY_DIR}/man COMMAND_ERROR_IS_FATAL ANY)")
install(DIRECTORY ${CMAKE_BINARY_DIR}/man/ DESTINATION share/man/man1)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME limber)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The authors of Limber <limber@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "changes the pose of labelled voxel anatomy")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL Unspecified)  # without the library's headers
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "fonts-inter, fonts-jetbrains-mono, fonts-font-awesome, libegl1, libgl1, libgl1-mesa-dri, libegl-mesa0")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "bash-completion")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "Limber reads a label volume (NRRD, MetaImage, NIfTI, DICOM) and a skeleton, works out how every voxel of tissue
follows the bones, takes a pose or motion capture, and writes a new label volume with a report of what changed.
It is an editor and a command line.")
include(CPack)
