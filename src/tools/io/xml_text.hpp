#pragma once
// The text of an XML file as UTF-8, whatever encoding its declaration names.

#include <string>

namespace manycontact::io {

/// Decodes the bytes of the file `path` as its byte order mark or declaration specifies: UTF-8 (the default), UTF-16,
/// US-ASCII, ISO-8859-1, ISO-8859-15 or Windows-1252. Line breaks remain where they were. Throws InputError, with the
/// line, for other encodings, invalid bytes, and references such as &#0; or &#xD800; that name no character of XML.
/// Comments may contain any bytes and are not decoded.
std::string decode_xml(const std::string& path, const std::string& bytes);

}  // namespace manycontact::io
