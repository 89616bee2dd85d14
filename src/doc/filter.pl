#!/usr/bin/perl
# Prints a header as Doxygen needs it, line by line: its plain comments become documentation.
#   the comment under #pragma once, and others at the margin with empty lines around them: of the file
#   x;  // text, and further lines of that comment: of the member x
#   struct x {  // text: of x, a function likewise
#   /// text above several declarations: of each of them
use strict;
use warnings;

my @lines = <>;
chomp @lines;

# Text outside `code` and indented blocks: < and # are characters.
sub plain {
  my ($text) = @_;
  return $text if $text =~ /^\s{4}/;
  my @parts = split /(`[^`]*`)/, $text;
  for (@parts) { s/(?<!\\)<(?=[A-Za-z\/])/\\</g, s/#(?=\w)/\\#/g, s/(?<=\s)-(?=\s)/\\-/g unless /^`/ }
  return join '', @parts;
}

# The group, a chapter of the reference (groups.dox), that a header's names are in.
my ($header) = ($ARGV // '') =~ m{manycontact/(.*)};
sub group_of {
  my ($name) = @_;
  return 'io' if $name =~ m{^(io/|analysis/load_scene)};
  return 'derivatives' if $name =~ m{^(dynamics/(differentiate|derivatives|jvp|aligned_panel)|contact/derivatives|algorithm/rnea_derivatives)};
  return 'scene' if $name =~ m{^(model/|contact/reference|analysis/(place|consistent))};
  return 'rigid_bodies' if $name =~ m{^(algorithm|spatial)/};
  return 'simulation' if $name =~ m{^simulation/};
  return 'optimal_control' if $name =~ m{^(action|control|task|crocoddyl)};
  return 'analysis' if $name =~ m{^analysis/};
  return 'contact_rows' if $name =~ m{^contact/rows};
  return 'solve';
}

my ($in_file_comment, $in_member_comment) = (0, 0);
my $column = 0;
for my $i (0 .. $#lines) {
  my $before = $i ? $lines[$i - 1] : '';
  for ($lines[$i]) {
    if (/^#pragma once/) {
      $_ = '/// @file';
      $in_file_comment = 1;
    } elsif (m{^// clang-format} && !$in_file_comment) {
      $_ = '';
    } elsif (m{^//( .*)?$} && ($in_file_comment || $before eq '')) {
      $lines[$i - 1] = '/// @file' unless $in_file_comment;
      my $text = $1 // '';
      $text = '' if $text =~ /^ clang-format/;
      $text = "    $text" if $text =~ /^ {2,}\S/ && $text !~ /^ {5}/ && $text !~ /^ +(\d\.|-|\*) /;
      $_ = '///' . plain($text);
      $in_file_comment = 1;
    } elsif (m{^(\s*)///(?!<)( ?)(.*)$}) {
      $_ = "$1/// " . plain($3);
      $in_file_comment = $in_member_comment = 0;
    } elsif (m!^(\s*[^/\s}#].*?[;,\w)}])(\s+)//\s(.*)$! && !m!\{\s+// ! && !m!^(struct|class) \w+;!) {
      $_ = "$1$2///< " . plain($3);
      $column = length("$1$2");
      $in_member_comment = 1;
      $in_file_comment = 0;
    } elsif (m!^( {0,2})((?:struct|class|enum|constexpr|SE3<).*\{)\s+// (.*)$!) {
      my ($indent, $code, $words) = ($1, $2, "/** " . plain($3) . " */");
      my $template = $before =~ /^\s*template/;
      $lines[$i - 1] = "$words $before" if $template;
      $_ = $template ? "$indent$code" : "$indent$words $code";
      $in_file_comment = $in_member_comment = 0;
    } elsif ($in_member_comment && m{^(\s+)//\s+(.*)$} && length($1) == $column) {
      $_ = "$1///< " . plain($2);
    } else {
      $in_file_comment = $in_member_comment = 0;
    }
  }
}

# Runs of lines without blank ones that start with /// and leave no brace open are groups of one documentation.
my $start = -1;
for my $i (0 .. $#lines + 1) {
  my $blank = $i > $#lines || $lines[$i] =~ /^\s*$/;
  if (!$blank) {
    $start = $i if $start < 0;
    next;
  }
  if ($start > 0 && $i <= $#lines && $lines[$start] =~ m{^\s*///} && $lines[$start] !~ /\@file/) {
    my $code = join "\n", map { my $l = $_; $l =~ s{//.*}{}; $l } @lines[$start .. $i - 1];
    my $open = () = $code =~ /\{/g;
    my $closed = () = $code =~ /\}/g;
    my $ends = () = $code =~ /[;}]\s*$/mg;
    if ($open == $closed && $ends > 1 && $code !~ /^\s*(struct|class|enum)/m) {
      $lines[$start - 1] .= '/** @{ */' if $lines[$start - 1] =~ m!^$|\@\} \*/$!;
      $lines[$i] = '/** @} */' if $lines[$start - 1] =~ m!\@\{ \*/$!;
    }
  }
  $start = -1;
}
if (defined $header) {
  my $group = group_of($header);
  for (@lines) {
    s!^namespace manycontact \{$!namespace manycontact { /** \@addtogroup $group\n\@{ */!;
    s!^\}  // namespace manycontact$!/** \@} */ }!;
  }
}
print "$_\n" for @lines;
