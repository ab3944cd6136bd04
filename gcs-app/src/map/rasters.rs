//! Pictures of the ground in tiles, as the map shows them: asked for by what is in view, kept as long as there is room.

use super::view::{Mercator, View};
use crate::tiles::{About, Answer, Desk, Done, Health, Reader, TileId, Wanted};
use egui::{Color32, Context, Mesh, Painter, Pos2, Rect, Shape, TextureHandle, TextureOptions, pos2, vec2};
use std::collections::HashMap;
use std::sync::Arc;

/// Most bytes of pictures that are kept; what is in view is kept in any case.
const MOST_BYTES: usize = 64 << 20;
/// Most tiles that are remembered, those without a picture among them.
const MOST_TILES: usize = 4096;
/// Most tiles of a view.
const MOST_IN_VIEW: usize = 400;
/// Pictures that go to the graphics card in one frame.
const A_FRAME: usize = 6;
/// So long until a tile that couldn't be had is asked for again, seconds.
const RETRY_S: f64 = 20.0;
/// So many levels above its first one a source is not shown: its tiles would be specks.
const TOO_FAR: f64 = 2.5;

/// A source of tiles on the map.
pub struct Raster {
    desk: Desk,
    about: About,
    tiles: HashMap<Wanted, Kept>,
    bytes: usize,
    frame: u64,
    /// All of the last view is here.
    is_whole: bool,
}

struct Kept {
    picture: Picture,
    /// The frame in which it was needed last.
    used: u64,
}

enum Picture {
    Here(TextureHandle, usize),
    None,
    /// Not before this time, seconds.
    Later(f64),
}

impl std::fmt::Debug for Raster {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Raster").field("tiles", &self.tiles.len()).finish_non_exhaustive()
    }
}

impl Raster {
    /// Reads tiles on a thread for each reader.
    pub fn new(readers: Vec<Box<dyn Reader>>, about: About, health: &Arc<Health>, ctx: &Context) -> Self {
        let ctx = ctx.clone();
        let wake: Arc<dyn Fn() + Send + Sync> = Arc::new(move || ctx.request_repaint());
        let desk = Desk::open(readers, health, &wake);
        Self { desk, about, tiles: HashMap::new(), bytes: 0, frame: 0, is_whole: false }
    }

    /// Nothing more of what was drawn last is on its way.
    pub fn is_whole(&self) -> bool {
        self.is_whole
    }

    /// So many pictures are here.
    pub fn pictures(&self) -> usize {
        self.tiles.values().filter(|kept| matches!(kept.picture, Picture::Here(..))).count()
    }

    /// Draws what is here of the view, and asks for what isn't.
    pub fn draw(&mut self, painter: &Painter, view: &View, opacity: f32, dark: bool) {
        self.frame += 1;
        let now_s = painter.ctx().input(|i| i.time);
        for _ in 0..A_FRAME {
            let Some(done) = self.desk.done() else { break };
            self.take(done, painter.ctx(), now_s);
        }
        let tint = Color32::WHITE.gamma_multiply(opacity.clamp(0.0, 1.0));
        let mut missing = Vec::new();
        for tile in in_view(view, &self.about) {
            let wanted = Wanted { tile, dark: dark && self.about.themed };
            if self.is_missing(wanted, now_s) {
                missing.push(wanted);
            }
            self.draw_tile(painter, view, wanted, tint);
        }
        self.is_whole = missing.is_empty();
        self.desk.want(missing);
        self.forget();
    }

    fn is_missing(&self, wanted: Wanted, now_s: f64) -> bool {
        self.tiles.get(&wanted).is_none_or(|kept| matches!(kept.picture, Picture::Later(at) if at <= now_s))
    }

    /// The tile, or what is here of one above it.
    fn draw_tile(&mut self, painter: &Painter, view: &View, wanted: Wanted, tint: Color32) {
        let mut source = wanted.tile;
        loop {
            if let Some(kept) = self.tiles.get_mut(&Wanted { tile: source, ..wanted }) {
                kept.used = self.frame;
                match &kept.picture {
                    Picture::Here(texture, _) => {
                        let mut mesh = Mesh::with_texture(texture.id());
                        mesh.add_rect_with_uv(on_screen(view, wanted.tile), part(source, wanted.tile), tint);
                        painter.add(Shape::mesh(mesh));
                        return;
                    }
                    Picture::None => return,
                    Picture::Later(_) => {}
                }
            }
            match source.parent() {
                Some(parent) if source.zoom > *self.about.zooms.start() => source = parent,
                _ => return,
            }
        }
    }

    fn take(&mut self, done: Done, ctx: &Context, now_s: f64) {
        let picture = match done.answer {
            Answer::Picture(image) => {
                let bytes = image.pixels.len() * 4;
                self.bytes += bytes;
                Picture::Here(ctx.load_texture("tile", image, TextureOptions::LINEAR), bytes)
            }
            Answer::Nothing | Answer::Unreadable => Picture::None,
            Answer::Later => {
                ctx.request_repaint_after(std::time::Duration::from_secs_f64(RETRY_S));
                Picture::Later(now_s + RETRY_S)
            }
        };
        if let Some(Kept { picture: Picture::Here(_, bytes), .. }) =
            self.tiles.insert(done.wanted, Kept { picture, used: self.frame })
        {
            self.bytes -= bytes;
        }
    }

    /// Drops what was needed longest ago, until there is room.
    fn forget(&mut self) {
        if self.bytes <= MOST_BYTES && self.tiles.len() <= MOST_TILES {
            return;
        }
        let old = self.tiles.iter().filter(|(_, kept)| kept.used < self.frame);
        let mut old: Vec<(u64, Wanted)> = old.map(|(wanted, kept)| (kept.used, *wanted)).collect();
        old.sort_by_key(|(used, _)| *used);
        for (_, wanted) in old {
            if self.bytes <= MOST_BYTES * 3 / 4 && self.tiles.len() <= MOST_TILES * 3 / 4 {
                return;
            }
            if let Some(Kept { picture: Picture::Here(_, bytes), .. }) = self.tiles.remove(&wanted) {
                self.bytes -= bytes;
            }
        }
    }
}

/// The tiles of a view, those in the middle first.
fn in_view(view: &View, about: &About) -> Vec<TileId> {
    let level = view.zoom();
    if level + TOO_FAR < f64::from(*about.zooms.start()) || !meets(view, about) {
        return Vec::new();
    }
    let zoom = (level.round().max(0.0) as u8).clamp(*about.zooms.start(), *about.zooms.end());
    let tiles = f64::from(zoom).exp2();
    let tile = |share: f64| (share * tiles).floor().clamp(0.0, tiles - 1.0) as u32;
    let (from, to) = (view.unit(view.rect.left_top()), view.unit(view.rect.right_bottom()));
    let columns = tile(from.x)..=tile(to.x);
    let rows = tile(from.y)..=tile(to.y);
    let all = rows.flat_map(|y| columns.clone().map(move |x| TileId { zoom, x, y }));
    let mut all: Vec<TileId> = all.take(MOST_IN_VIEW).collect();
    let middle = view.rect.center();
    all.sort_by_key(|tile| on_screen(view, *tile).center().distance(middle) as u32);
    all
}

/// Something of the source may be in view.
fn meets(view: &View, about: &About) -> bool {
    about.bounds.is_none_or(|(south_west, north_east)| {
        // one across the antimeridian has its corners the other way round
        south_west.lon_deg >= north_east.lon_deg
            || Rect::from_two_pos(view.place(south_west), view.place(north_east)).intersects(view.rect)
    })
}

fn on_screen(view: &View, tile: TileId) -> Rect {
    let tiles = f64::from(tile.zoom).exp2();
    let corner = |x: u32, y: u32| view.screen(Mercator { x: f64::from(x) / tiles, y: f64::from(y) / tiles });
    Rect::from_two_pos(corner(tile.x, tile.y), corner(tile.x + 1, tile.y + 1))
}

/// Where in the picture of a tile another one is that lies in it.
fn part(of: TileId, tile: TileId) -> Rect {
    let times = f32::from(tile.zoom - of.zoom).exp2();
    let at = |inside: u32, from: u32| inside as f32 - from as f32 * times;
    let corner = pos2(at(tile.x, of.x), at(tile.y, of.y)) / times;
    Rect::from_min_size(corner, vec2(1.0, 1.0) / times)
        .intersect(Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_tile_is_where_it_lies() {
        let parent = TileId { zoom: 10, x: 300, y: 400 };
        let child = TileId { zoom: 12, x: 1203, y: 1600 };
        assert_eq!(part(parent, child), Rect::from_min_size(pos2(0.75, 0.0), vec2(0.25, 0.25)));
        assert_eq!(part(parent, parent), Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0)));
        assert_eq!(child.parent().and_then(TileId::parent), Some(parent));
    }
}
