#pragma once
// The text of an XML file as UTF-8, whatever encoding its declaration names.

#include <string>

namespace manycontact::io {

/// Decodes the bytes of the file `path` as their byte order mark or declaration says: UTF-8 (the default), UTF-16,
/// US-ASCII, ISO-8859-1, ISO-8859-15, Windows-1252. Line breaks stay where they were. Throws InputError, with the line:
/// another encoding, bytes that are none of it, references such as &#0; or &#xD800; that name no character of XML.
/// Comments may hold any bytes: nothing of them is read.
std::string decode_xml(const std::string& path, const std::string& bytes);

}  // namespace manycontact::io
