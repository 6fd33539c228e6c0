//! `cargo xtask site`: the page that simulates, the documentation with a search, and the API, as files for any web server.

use crate::tools::{cargo, root, say, step, target};
use crate::web;
use pulldown_cmark::{CowStr, Event, Options, Parser, Tag, TagEnd, html};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fs;
use std::path::{Component, Path, PathBuf};

/// What the site begins with; pages that these link to are part of it, too.
const BEGINNINGS: [&str; 2] = ["README.md", "docs/README.md"];

/// Builds `target/site`.
pub(crate) fn run() -> Result<(), String> {
    let folder = target().join("site");
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    let pages = documentation(root(), &folder)?;
    web::run()?;
    copy(&target().join("web/myospring.html"), &folder.join("myospring.html"))?;
    step("the API", cargo(["doc", "--no-deps", "--locked", "-p", "myospring"]))?;
    copy_folder(&target().join("doc"), &folder.join("api"))?;
    say(&format!("{}: {pages} pages, myospring.html, api\n", folder.join("index.html").display()));
    Ok(())
}

/// A page of the site while it is made.
#[derive(Default)]
struct Page {
    title: String,
    html: String,
    /// Names of its headings.
    anchors: BTreeSet<String>,
    parts: Vec<Part>,
}

/// A part of a page, for the search.
#[derive(Serialize)]
struct Part {
    at: String,
    page: String,
    heading: String,
    text: String,
}

/// Writes the pages of the Markdown files of a project, and the files that they link to; gives how many pages. A link that leads
/// nowhere is an error.
fn documentation(project: &Path, folder: &Path) -> Result<usize, String> {
    let mut todo: VecDeque<PathBuf> = BEGINNINGS.iter().map(PathBuf::from).collect();
    let mut pages: BTreeMap<PathBuf, Page> = BTreeMap::new();
    let (mut files, mut folders, mut anchors) = (BTreeSet::new(), BTreeSet::new(), Vec::new());
    while let Some(file) = todo.pop_front() {
        if pages.contains_key(&file) {
            continue;
        }
        let text = fs::read_to_string(project.join(&file))
            .map_err(|error| format!("{}: {error}", file.display()))?;
        let (page, links) = page(project, &file, &text);
        for (to, anchor) in links {
            let there = project.join(&to);
            if there.is_dir() {
                folders.insert(to);
            } else if !there.is_file() {
                let (file, to) = (file.display(), to.display());
                return Err(format!("{file} links to {to}, which is neither file nor folder"));
            } else if is_page(&to) {
                anchors.extend(anchor.map(|anchor| (file.clone(), to.clone(), anchor)));
                todo.push_back(to);
            } else {
                files.insert(to);
            }
        }
        pages.insert(file, page);
    }
    for (from, to, anchor) in anchors {
        if !pages.get(&to).is_some_and(|page| page.anchors.contains(&anchor)) {
            let (from, to) = (from.display(), to.display());
            return Err(format!("{from} links to {to}#{anchor}, and there is no such heading"));
        }
    }
    for listed in folders {
        let inside = listing(project, &listed)?;
        let items: Vec<String> = inside.iter().map(|name| format!("- [{name}]({name})")).collect();
        let items = items.join("\n");
        let index = listed.join("README.md");
        let (page, _) = page(project, &index, &format!("# {}\n\n{items}", listed.display()));
        files.extend(inside.iter().map(|name| listed.join(name)));
        pages.entry(index).or_insert(page);
    }
    for file in &files {
        copy(&project.join(file), &folder.join(file))?;
    }
    let all: Vec<&Part> = pages.values().flat_map(|page| &page.parts).collect();
    let all = serde_json::to_string(&all).map_err(|error| error.to_string())?;
    write(&folder.join("search-data.js"), &format!("const PARTS = {all};\n"))?;
    write(&folder.join("search.js"), include_str!("site/search.js"))?;
    write(&folder.join("site.css"), include_str!("site/site.css"))?;
    for (file, page) in &pages {
        let up = "../".repeat(file.components().count() - 1);
        let whole = include_str!("site/page.html")
            .replace("{{title}}", &page.title)
            .replace("{{up}}", &up)
            .replacen("{{text}}", &page.html, 1);
        write(&folder.join(address(file)), &whole)?;
    }
    Ok(pages.len())
}

/// Names of the files in a folder.
fn listing(project: &Path, folder: &Path) -> Result<Vec<String>, String> {
    let failed = |error| format!("{}: {error}", folder.display());
    let entries = fs::read_dir(project.join(folder)).map_err(failed)?;
    let files = entries.filter_map(|entry| entry.ok().filter(|entry| entry.path().is_file()));
    let mut names: Vec<String> =
        files.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    Ok(names)
}

fn is_page(file: &Path) -> bool {
    file.extension().is_some_and(|ending| ending == "md")
}

/// Where the page of a Markdown file is.
fn address(file: &Path) -> PathBuf {
    if file.file_stem().is_some_and(|stem| stem == "README") {
        file.with_file_name("index.html")
    } else {
        file.with_extension("html")
    }
}

/// A file of the project, and a heading in it.
type Link = (PathBuf, Option<String>);

/// The page of a Markdown file, and the files of the project that it links to.
fn page(project: &Path, file: &Path, text: &str) -> (Page, Vec<Link>) {
    let options = Options::ENABLE_TABLES | Options::ENABLE_STRIKETHROUGH;
    let mut events: Vec<Event<'_>> = Parser::new_ext(text, options).collect();
    let (mut page, mut links) = (Page::default(), Vec::new());
    let place = address(file).to_string_lossy().replace('\\', "/");
    let mut part: Option<Part> = None;
    for at in 0..events.len() {
        if let Event::Start(Tag::Heading { .. }) = &events[at] {
            let words = words(&events[at + 1..]);
            let name = free(&slug(&words), &page.anchors);
            page.anchors.insert(name.clone());
            if page.title.is_empty() {
                page.title.clone_from(&words);
            }
            page.parts.extend(part.replace(Part {
                at: format!("{place}#{name}"),
                page: page.title.clone(),
                heading: words,
                text: String::new(),
            }));
            if let Event::Start(Tag::Heading { id, .. }) = &mut events[at] {
                *id = Some(CowStr::from(name));
            }
        }
        match &mut events[at] {
            Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                if let Some((to, anchor)) = within(file, dest_url) {
                    let behind = anchor.as_ref().map_or_else(String::new, |it| format!("#{it}"));
                    if project.join(&to).is_dir() {
                        *dest_url = way(file, &to.join("index.html")).into();
                    } else if is_page(&to) {
                        *dest_url = format!("{}{behind}", way(file, &address(&to))).into();
                    }
                    links.push((to, anchor));
                }
            }
            Event::Text(text) | Event::Code(text) => {
                if let Some(part) = &mut part {
                    part.text.push_str(text);
                    part.text.push(' ');
                }
            }
            _ => {}
        }
    }
    page.parts.extend(part);
    html::push_html(&mut page.html, events.into_iter());
    (page, links)
}

/// Plain words of a heading.
fn words(after: &[Event<'_>]) -> String {
    let until = after.iter().take_while(|event| !matches!(event, Event::End(TagEnd::Heading(_))));
    let text = until.filter_map(|event| match event {
        Event::Text(text) | Event::Code(text) => Some(&**text),
        _ => None,
    });
    text.collect()
}

/// The name of a heading, as hosts of repositories make it.
fn slug(words: &str) -> String {
    let kept = words.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.flat_map(char::to_lowercase).map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// A name that is not taken.
fn free(name: &str, taken: &BTreeSet<String>) -> String {
    let numbered = (1..).map(|number| format!("{name}-{number}"));
    let mut names = std::iter::once(name.to_owned()).chain(numbered);
    names.find(|name| !taken.contains(name)).unwrap_or_default()
}

/// The file of the project to which an address in a file leads, and the heading in it; `None` if it leads elsewhere.
fn within(file: &Path, address: &str) -> Option<Link> {
    if address.contains("://") || address.starts_with("mailto:") {
        return None;
    }
    let (path, anchor) =
        address.split_once('#').map_or((address, None), |(path, it)| (path, Some(it)));
    let from = file.parent().unwrap_or_else(|| Path::new(""));
    let to = if path.is_empty() { file.to_owned() } else { plain(&from.join(path)) };
    Some((to, anchor.map(str::to_owned)))
}

/// A path without `.` and `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for component in path.components() {
        match component {
            Component::ParentDir => {
                plain.pop();
            }
            Component::Normal(name) => plain.push(name),
            _ => {}
        }
    }
    plain
}

/// The address of a file as another one links to it.
fn way(from: &Path, to: &Path) -> String {
    let up = "../".repeat(from.components().count() - 1);
    format!("{up}{}", to.to_string_lossy().replace('\\', "/"))
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    let failed = |error| format!("{}: {error}", path.display());
    path.parent().map_or(Ok(()), fs::create_dir_all).map_err(failed)?;
    fs::write(path, text).map_err(failed)
}

fn copy(from: &Path, to: &Path) -> Result<(), String> {
    let failed = |error| format!("{} to {}: {error}", from.display(), to.display());
    to.parent().map_or(Ok(()), fs::create_dir_all).map_err(failed)?;
    fs::copy(from, to).map(|_| ()).map_err(failed)
}

fn copy_folder(from: &Path, to: &Path) -> Result<(), String> {
    let failed = |error| format!("{}: {error}", from.display());
    for entry in fs::read_dir(from).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let (path, target) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() { copy_folder(&path, &target)? } else { copy(&path, &target)? }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_link_of_the_documentation_leads_to_a_page_a_file_or_a_heading() {
        let folder = tempfile::tempdir().unwrap();
        let pages = documentation(root(), folder.path()).unwrap();
        assert!(pages > 30, "{pages}");
        let fits = fs::read_to_string(folder.path().join("docs/how-to/fits.html")).unwrap();
        assert!(fits.contains("<h2 id=\"where-the-cell-pulls\">"));
        assert!(fits.contains(
            "href=\"../../docs/explanation/which-cell-model.html#a-tension-of-your-own\""
        ));
        assert!(folder.path().join("docs/pictures/fit.png").is_file());
        let data = fs::read_to_string(folder.path().join("search-data.js")).unwrap();
        assert!(data.contains("docs/how-to/fits.html#where-the-cell-pulls"));
    }

    #[test]
    fn a_link_that_leads_nowhere_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        write(&folder.path().join("README.md"), "# A\n[b](docs/README.md#nowhere)").unwrap();
        write(&folder.path().join("docs/README.md"), "# B").unwrap();
        let error = documentation(folder.path(), &folder.path().join("site")).unwrap_err();
        assert!(error.contains("#nowhere"), "{error}");
    }

    #[test]
    fn names_of_headings_are_those_of_hosts() {
        assert_eq!(slug("Which cell model? `land_2017`, 1 Hz"), "which-cell-model-land_2017-1-hz");
    }
}
